//! Edge functions of sixteen small triangles, one per lane, for each rule of coverage.

pub(crate) use self::edges::{Edges, SampledEdges};
pub(crate) use self::floats::FloatEdges;
pub(crate) use self::usual::UsualEdges;
pub(crate) use self::whole::{FineEdges, WholeEdges};

mod edges;
mod floats;
mod usual;
mod whole;

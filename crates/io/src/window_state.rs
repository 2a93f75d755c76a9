//! The state of the window in scene files and preferences.

use std::collections::BTreeMap;
use std::fmt;

use ron::value::RawValue;
use serde::de::{self, Deserializer, MapAccess, Visitor};
use serde::ser::{self, Serializer};
use serde::{Deserialize, Serialize};

/// The state of the window when a scene was saved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WindowState {
    /// Whether pictures may be coarser during motion, if full quality would be too slow.
    pub coarse_while_moving: bool,
    /// Which panels are open.
    pub panels: Panels,
}

impl WindowState {
    /// The state at the first start.
    pub const DEFAULT: Self = Self { coarse_while_moving: true, panels: Panels(BTreeMap::new()) };
}

/// The open and closed panels, by name. Other panels have their state of the first start.
///
/// Files contain arbitrary names: only the window knows the panels, and ignores unknown ones. The
/// format is that of a struct: `(outline: true, plan: false)`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Panels(BTreeMap<String, bool>);

impl Panels {
    /// Returns whether a panel is open, if it is listed.
    pub fn is_open(&self, name: &str) -> Option<bool> {
        self.0.get(name).copied()
    }
}

impl<'a> FromIterator<(&'a str, bool)> for Panels {
    fn from_iter<T: IntoIterator<Item = (&'a str, bool)>>(panels: T) -> Self {
        Self(panels.into_iter().map(|(name, open)| (name.to_owned(), open)).collect())
    }
}

impl Serialize for Panels {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let fields: Vec<String> =
            self.0.iter().map(|(name, open)| format!("{name}: {open}")).collect();
        let text = format!("({})", fields.join(", "));
        RawValue::from_boxed_ron(text.into()).map_err(ser::Error::custom)?.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Panels {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_struct("Panels", &[], Fields)
    }
}

/// Deserializes arbitrary panel names with their states.
struct Fields;

impl<'de> Visitor<'de> for Fields {
    type Value = Panels;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("struct Panels")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Panels, A::Error> {
        let mut panels = BTreeMap::new();
        while let Some((Name(name), open)) = fields.next_entry()? {
            panels.insert(name, open);
        }
        Ok(Panels(panels))
    }
}

/// The name of a field.
struct Name(String);

impl<'de> Deserialize<'de> for Name {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Named;
        impl Visitor<'_> for Named {
            type Value = Name;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("identifier")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<Name, E> {
                Ok(Name(name.to_owned()))
            }
        }
        deserializer.deserialize_identifier(Named)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_are_written_as_fields_and_names_of_other_programs_are_kept() {
        let panels: Panels = [("outline", true), ("plan", false)].into_iter().collect();
        assert_eq!(ron::to_string(&panels).unwrap(), "(outline: true, plan: false)");
        for text in ["(outline:true,plan:false)", "( plan : false,\n outline: true, )"] {
            assert_eq!(ron::from_str::<Panels>(text).unwrap(), panels);
        }
        let newer: Panels = ron::from_str("(curves: true)").unwrap();
        assert_eq!((newer.is_open("curves"), newer.is_open("plan")), (Some(true), None));
        assert_eq!(ron::from_str::<Panels>("()").unwrap(), Panels::default());
        assert!(ron::from_str::<Panels>("(plan: 1)").is_err());
    }
}

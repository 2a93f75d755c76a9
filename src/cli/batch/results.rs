//! Collects the results of a batch: report, cameras, tables, archives.

use std::path::Path;
use std::sync::Arc;

use super::meter::Meter;
use super::outcome::{Fault, Outcome};
use super::report::Reporter;
use super::seeds::SEED_POINTS;
use super::studio::Studio;
use super::tables::Tables;
use super::tars::Tars;
use super::{Batch, is_part};
use crate::cli::cameras::{Cameras, Earlier};
use crate::cli::failure::Failure;

/// The results of a batch, as they come.
pub(super) struct Results<'a> {
    pub(super) meter: Meter,
    pub(super) reporter: Reporter<'a>,
    pub(super) cameras: Cameras,
    /// The tables of a data set.
    pub(super) tables: Option<Tables>,
    pub(super) tars: Option<Tars>,
    /// The numbers and positions of finished jobs, for contact sheets.
    pub(super) done: Vec<(usize, usize)>,
    has_sheets: bool,
    stops: bool,
    /// The number of pictures of models with findings.
    pub(super) repaired: usize,
}

impl<'a> Results<'a> {
    pub(super) fn begin(
        arguments: &Batch,
        name: String,
        studio: &'a Studio,
    ) -> Result<Self, Failure> {
        let plan = studio.plan();
        let (report, times) = (arguments.report.as_deref(), arguments.times.as_deref());
        let folder = Path::new(arguments.out.as_deref().unwrap_or_default());
        let ply = arguments.seed_points.map(|_count| SEED_POINTS);
        let earlier = match arguments.dataset {
            Some(_) => Earlier::Dropped,
            None => Earlier::Kept,
        };
        Ok(Self {
            meter: Meter::of(plan.len()),
            reporter: Reporter::begin(plan, report, times)?,
            cameras: Cameras::new(name, earlier, (arguments.split, ply)),
            // A part of a list does not know all models: the tables are left to a last run.
            tables: arguments
                .dataset
                .filter(|_| !is_part(arguments))
                .and_then(|dataset| Tables::of(dataset, folder)),
            tars: plan.tars().zip(studio.earlier_tars()).map(|(names, earlier)| {
                Tars::new(Arc::clone(names), plan.all, Arc::clone(earlier))
            }),
            done: Vec::new(),
            has_sheets: arguments.sheet.is_some(),
            stops: arguments.stop,
            repaired: 0,
        })
    }

    /// Adds a result. Returns whether the batch goes on. Fails if a file cannot be written.
    pub(super) fn add(&mut self, mut outcome: Outcome) -> Result<bool, Failure> {
        self.meter.add(&outcome);
        self.reporter.add(&outcome)?;
        let job = &outcome.job;
        if let (Some(tars), false) = (&mut self.tars, outcome.result == Err(Fault::Cancelled)) {
            let drawn = outcome.result.as_mut().ok();
            let members = drawn.map(|drawn| std::mem::take(&mut drawn.members));
            tars.add(job.index, members.unwrap_or_default())?;
        }
        let Ok(drawn) = &mut outcome.result else { return Ok(!self.stops) };
        if self.has_sheets {
            self.done.push((job.index, job.position));
        }
        self.repaired += usize::from(!drawn.findings.is_empty());
        match (&mut self.tables, &drawn.image) {
            (Some(tables), Some(image)) => tables.add(job, image)?,
            (None, Some(_)) => {}
            (_, None) => {
                drawn.camera.take().map_or(Ok(()), |camera| self.cameras.add(*camera))?;
            }
        }
        Ok(true)
    }
}

//! Pictures against references: every metric, thresholds, and the verdict, for two files or two folders.
//!
//! [`run()`] is the whole command; [`load()`] and [`Mask`] read pictures the way it does.

mod args;
mod check;
mod comparison;
mod error;
mod error_map;
mod files;
mod github;
mod junit;
mod load;
mod mask;
mod noise;
mod page;
mod pairs;
mod pictures;
mod report;
mod run;
mod table;
mod update;
mod variance;

pub use args::{CompareArgs, VarianceOf};
pub(crate) use comparison::{CompareOptions, compare};
pub use error::CompareError;
pub use load::{Loaded, load};
pub use mask::Mask;
pub use pictures::{Judged, Picture, judge};
pub use report::Status;
pub use run::run;
pub(crate) use variance::{VarianceKind, beside as variance_beside};

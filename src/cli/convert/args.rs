//! The arguments of `convert`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::cli::scene::{SpectralRule, pair};

/// Arguments of `convert`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// Scene to read: Mitsuba .xml of any version, pbrt-v4 .pbrt (v3 is upgraded)
    pub input: PathBuf,
    /// Scene to write; its extension says the language (.xml: Mitsuba 3, .pbrt: pbrt-v4)
    pub output: PathBuf,
    /// Value of a scene parameter `$NAME`
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = pair)]
    pub define: Vec<(String, String)>,
    /// Write the losses as JSON
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    /// Render both scenes, small, and fail when they differ by more than noise
    #[arg(long)]
    pub check: bool,
    /// Render the source here and the result with its own renderer, where that is installed, and fail when their
    /// means differ by more than 1 % and noise
    #[arg(long, value_name = "RENDERER", value_enum)]
    pub check_with: Option<Renderer>,
    /// Replace files that exist
    #[arg(long)]
    pub force: bool,
    /// How spectra that the language cannot say become RGB (as for `render`)
    #[arg(long, value_name = "RULE", value_enum, default_value = "mitsuba3")]
    pub spectral_to_rgb: SpectralRule,
    /// What is unknown or not supported becomes the nearest thing that is, with a warning
    #[arg(long, alias = "allow-unsupported")]
    pub lenient: bool,
    /// Also read and search this folder; a scene may read below its own folder only
    #[arg(long, value_name = "DIR")]
    pub allow_path: Vec<PathBuf>,
}

/// A renderer that may be installed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Renderer {
    /// Mitsuba 3, as a module of python3
    Mitsuba,
    /// pbrt-v4, as the program pbrt
    Pbrt,
}

//! Studies of photon mapping's parameters: what each costs and gains, against what a document on them says.

mod catalogue;
mod curves;
mod measure;
mod page;
mod reference;
mod verdict;

use super::args::BenchArgs;
use super::error::BenchError;
use super::files;
use super::machine::Machine;
use super::renderers::Programs;
use catalogue::{NAMES, Profile};
use measure::Bench;
use page::{Common, Made};
use reference::Reference;
use std::io::Write;

/// Makes the study `name`, or `all`, in `args.output`: README.md, plots and pictures. The renders stay in its
/// folder `work`, where an interrupted run continues.
///
/// # Errors
/// There is no such study, the renderer fails, or a file cannot be read or written.
pub fn run(name: &str, args: &BenchArgs, programs: Programs, out: &mut dyn Write) -> Result<(), BenchError> {
    let names: Vec<&str> = NAMES.into_iter().filter(|n| name == "all" || name == *n).collect();
    if names.is_empty() {
        return Err(BenchError::Usage(format!(
            "there is no study `{name}`; the studies are {} and all",
            NAMES.join(", ")
        )));
    }
    let profile = if args.quick { Profile::QUICK } else { Profile::FULL };
    let machine = Machine::here(args.threads);
    let work = args.output.join("work");
    files::make_folder(&work)?;
    files::write(&work.join(".gitignore"), b"*\n")?;
    let mut made = Vec::new();
    for study in names.iter().filter_map(|n| catalogue::study(n, profile)) {
        let scene = reference::scene(study.scene, &work)?;
        let Reference { pixels: truth, noise } =
            Reference::new(&programs, &scene, &work, profile, study.truth)?;
        let bench = Bench { programs: &programs, scene: &scene, reference: &truth, work: &work };
        let mut rows = Vec::new();
        for variant in &study.variants {
            let row = bench.variant(&study, variant)?;
            writeln!(
                out,
                "{}: {}: {:.2} s, RMSE {:.4} (bias {:.4}, noise {:.4}), FLIP {:.4}",
                study.name, row.label, row.seconds, row.rmse, row.bias_rms, row.noise_rms, row.flip
            )?;
            out.flush()?;
            rows.push(row);
        }
        made.push(Made { study, rows, truth, noise });
    }
    let mut checks = Vec::new();
    for scene in ["cornell-diffuse", "cornell-glass"] {
        checks.push(reference::check(scene, &programs, &work, profile)?);
    }
    let quick = if args.quick { " --quick" } else { "" };
    let common = Common {
        machine: &machine,
        profile,
        checks: &checks,
        command: format!("caustica bench --study {name}{quick} -o {}", args.output.display()),
        cpu_seconds: made.iter().flat_map(|m| &m.rows).map(|r| r.cpu_seconds * r.seeds as f64).sum(),
    };
    page::write(&made, &common, &args.output)?;
    writeln!(out, "machine: {}\nwrote {}", machine.line(), args.output.join("README.md").display())?;
    Ok(())
}

//! JUnit XML as others read it: Python's junitparser counts what the run found.

use caustica_formats::image::{ExrLayer, ExrOptions, write_exr};
use caustica_tools::compare::{CompareArgs, run};
use libtest_mimic::{Arguments, Completion, Failed, Trial};
use std::path::Path;
use std::process::{Command, ExitCode};

const INSTALL: &str = "no junitparser; install it with: python3 -m pip install junitparser";

/// Name, verdict and message of each case, the counts of the suite, and one property.
const SCRIPT: &str = r#"
import sys
try:
    from junitparser import JUnitXml
except ImportError:
    sys.exit(77)
xml = JUnitXml.fromfile(sys.argv[1])
for suite in xml:
    print('suite', suite.tests, suite.failures, suite.errors, suite.skipped)
    print('rmse', {p.name: p.value for p in suite.properties()}['b.rmse'])
    for case in suite:
        ends = [(type(r).__name__, r.message) for r in case.result] or [('Passed', '')]
        print(case.name, *ends[0], sep='|')
"#;

fn main() -> ExitCode {
    let trial = Trial::ignorable_test("junit_xml_read_by_junitparser", || {
        let folder = tempfile::tempdir()?;
        let found = read(folder.path())?;
        match found {
            None => Ok(Completion::ignored_with(INSTALL)),
            Some(found) => check(&found).map(|()| Completion::Completed),
        }
    });
    libtest_mimic::run(&Arguments::from_args(), vec![trial]).exit_code()
}

fn picture(path: &Path, value: f32) -> Result<(), Failed> {
    std::fs::create_dir_all(path.parent().ok_or("a folder")?)?;
    let layer = ExrLayer { name: "", channels: &["R", "G", "B"], data: &[value; 600] };
    Ok(write_exr(path, 20, 10, &[layer], &[], ExrOptions::default())?)
}

/// What junitparser reads of a run; `None` without it.
fn read(folder: &Path) -> Result<Option<String>, Failed> {
    for (name, value) in [("a & <b>", 0.5), ("b", 0.6), ("extra", 0.5)] {
        picture(&folder.join(format!("images/{name}.exr")), value)?;
    }
    for name in ["a & <b>", "b", "gone"] {
        picture(&folder.join(format!("references/{name}.exr")), 0.5)?;
    }
    let junit = folder.join("out.xml");
    let args = CompareArgs {
        max_rmse: Some(0.05),
        no_hdr: true,
        junit: Some(junit.clone()),
        ..CompareArgs::new(folder.join("images"), folder.join("references"))
    };
    run(&args, &mut Vec::new());
    let Ok(output) = Command::new("python3").arg("-c").arg(SCRIPT).arg(&junit).output() else {
        return Ok(None);
    };
    if output.status.code() == Some(77) {
        return Ok(None);
    }
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    Ok(Some(String::from_utf8(output.stdout)?))
}

fn check(found: &str) -> Result<(), Failed> {
    let lines: Vec<&str> = found.lines().collect();
    let begin =
        ["suite 4 1 1 1", "rmse 0.1", "a & <b>|Passed|", "b|Failure|rmse 0.100000 > 0.05", "gone|Error|"];
    let same = |(line, start): (&&str, &&str)| line.starts_with(start);
    if lines.len() == 6 && lines.iter().zip(&begin).all(same) && lines[5].starts_with("extra|Skipped|") {
        Ok(())
    } else {
        Err(found.to_owned().into())
    }
}

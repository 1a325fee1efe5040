//! What is found out about a scene, whether or not it can be rendered.

use std::path::{Path, PathBuf};

use caustica_formats::confined::Confined;
use caustica_formats::read_scene;

use super::describe::Contents;
use super::{Description, Error, Finding, Options, Session};

/// A scene that was looked at. Where it cannot be rendered, there is as much of it as could be found out.
#[derive(Debug)]
pub struct Inspection {
    path: PathBuf,
    /// The scene, or if it is refused what `lenient` makes of it.
    session: Option<Session>,
    /// What the files say, where there is no session.
    contents: Option<Contents>,
    findings: Vec<Finding>,
    /// Why the scene is refused.
    pub failure: Option<Error>,
}

impl Inspection {
    /// Opens the scene as [`Session::open`] does; [`Self::failure`] is what that fails with.
    ///
    /// # Errors
    /// When what was asked for is wrong, so that nothing was looked at.
    pub fn of(path: impl AsRef<Path>, options: &Options) -> Result<Self, Error> {
        let path = path.as_ref();
        let mut findings = Vec::new();
        let (session, contents, failure) = match Session::open(path, options) {
            Ok(session) => return Ok(Self::of_session(session)),
            Err(error @ Error::Scene(_)) => {
                findings.extend(error.findings());
                let (session, contents) = substitute(path, options);
                (session, contents, Some(error))
            }
            Err(error) => return Err(error),
        };
        Ok(Self { path: path.to_path_buf(), session, contents, findings, failure })
    }

    /// Of a scene that is open.
    pub fn of_session(session: Session) -> Self {
        let mut findings = session.findings().to_vec();
        // That is not the scene's fault: another machine renders it.
        findings.extend(session.check_memory().err().map(|e| Finding::warning(e.to_string())));
        let path = session.path().to_path_buf();
        Self { path, session: Some(session), contents: None, findings, failure: None }
    }

    /// For people, of a scene that can be rendered: what is worth a warning, without what is not supported, which
    /// [`Self::describe`] lists.
    pub fn warnings(&self) -> String {
        let Some(session) = &self.session else { return String::new() };
        let memory = session.check_memory().err().map(|e| format!("warning: {e}"));
        let texts = [session.other_warnings().to_owned(), memory.unwrap_or_default()];
        texts.join("\n").trim().to_owned()
    }

    /// What is in the scene, what rendering it will do, and what is wrong with it.
    pub fn describe(&self) -> Description<'_> {
        let (session, contents) = (self.session.as_ref(), self.contents.as_ref());
        Description::of(&self.path, self.failure.is_none(), &self.findings, session, contents)
    }
}

/// What can be said of a scene that is refused.
fn substitute(path: &Path, options: &Options) -> (Option<Session>, Option<Contents>) {
    let lenient = Options { lenient: true, ..options.clone() };
    let files = Confined::new(path, &options.allow_paths);
    let Ok(mut read) = read_scene(&files, path, &lenient.reading()) else { return (None, None) };
    // What is broken stays so; only what is unknown or not supported has a substitute.
    let session = if options.lenient { None } else { Session::open(path, &lenient).ok() };
    let contents = session.is_none().then(|| {
        lenient.override_film(&mut read.scene);
        Contents::of(&read.scene, options.sensor)
    });
    (session, contents)
}

//! What is measured: a renderer and its settings.

use super::error::BenchError;

/// A renderer with its settings.
#[derive(Clone, Debug, PartialEq)]
pub enum Renderer {
    /// caustica, with settings for `--set`.
    Ours {
        settings: Vec<(String, String)>,
    },
    Mitsuba {
        variant: String,
        integrator: String,
    },
    Pbrt {
        integrator: String,
        parameters: Vec<(String, String)>,
    },
}

/// A renderer with its settings, named as on the command line.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    pub name: String,
    pub renderer: Renderer,
}

impl Config {
    /// Parses `caustica`, `caustica:path`, `caustica:KEY=VALUE,KEY=VALUE`, `mitsuba:VARIANT:INTEGRATOR` or
    /// `pbrt:INTEGRATOR[,KEY=VALUE...]`.
    ///
    /// # Errors
    /// Any other name.
    pub fn parse(name: &str) -> Result<Self, BenchError> {
        let wrong = || BenchError::Config(name.to_owned());
        let (program, rest) = name.split_once(':').unwrap_or((name, ""));
        let renderer = match program {
            "caustica" => {
                let tokens = rest.split(',').map(str::trim).filter(|t| !t.is_empty());
                Renderer::Ours { settings: tokens.map(setting).collect::<Option<_>>().ok_or_else(wrong)? }
            }
            "mitsuba" => {
                let (variant, integrator) =
                    rest.split_once(':').filter(|(v, i)| !v.is_empty() && !i.is_empty()).ok_or_else(wrong)?;
                Renderer::Mitsuba { variant: variant.to_owned(), integrator: integrator.to_owned() }
            }
            "pbrt" => {
                let mut tokens = rest.split(',').map(str::trim);
                let integrator =
                    tokens.next().filter(|i| !i.is_empty() && !i.contains('=')).ok_or_else(wrong)?;
                let parameters = tokens.map(parameter).collect::<Option<_>>().ok_or_else(wrong)?;
                Renderer::Pbrt { integrator: integrator.to_owned(), parameters }
            }
            _ => return Err(wrong()),
        };
        Ok(Self { name: name.to_owned(), renderer })
    }
}

/// `KEY=VALUE`.
fn parameter(token: &str) -> Option<(String, String)> {
    let (key, value) = token.split_once('=').filter(|(k, v)| !k.is_empty() && !v.is_empty())?;
    Some((key.to_owned(), value.to_owned()))
}

/// `KEY=VALUE`, or the name of an integrator or of a mode.
fn setting(token: &str) -> Option<(String, String)> {
    let owned = |a: &str, b: &str| Some((a.to_owned(), b.to_owned()));
    match token {
        "path" | "photonmap" => owned("integrator", token),
        "classic" | "progressive" => owned("mode", token),
        _ => parameter(token),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_configurations() {
        let ours = |name: &str| match Config::parse(name).unwrap().renderer {
            Renderer::Ours { settings } => settings,
            other => panic!("{other:?}"),
        };
        assert!(ours("caustica").is_empty());
        assert_eq!(ours("caustica:path"), [("integrator".to_owned(), "path".to_owned())]);
        assert_eq!(ours("caustica:alpha=0.5,nee=false").len(), 2);
        let mitsuba = Config::parse("mitsuba:scalar_rgb:path").unwrap().renderer;
        let expected = Renderer::Mitsuba { variant: "scalar_rgb".to_owned(), integrator: "path".to_owned() };
        assert_eq!(mitsuba, expected);
        let pbrt = Config::parse("pbrt:sppm,radius=0.05").unwrap().renderer;
        let parameters = vec![("radius".to_owned(), "0.05".to_owned())];
        assert_eq!(pbrt, Renderer::Pbrt { integrator: "sppm".to_owned(), parameters });
        for wrong in
            ["", "mitsuba", "mitsuba:scalar_rgb", "pbrt", "pbrt:sppm,x", "blender:x", "caustica:alpha"]
        {
            assert!(Config::parse(wrong).is_err(), "{wrong}");
        }
    }
}

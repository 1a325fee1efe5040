//! Line plots as SVG with logarithmic or linear axes. The legend is beside the plot.

use crate::html::escape;
use std::fmt::Write;

/// Colours that colour-blind readers can tell apart (Okabe and Ito 2008), dark enough on white.
const COLOURS: [&str; 9] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b58900", "#56b4e9", "#444444", "#7b3294", "#8c6d31"];

/// One curve.
#[derive(Clone, Debug, Default)]
pub struct Series {
    pub name: String,
    /// Points joined by a line.
    pub line: Vec<(f64, f64)>,
    /// Single measurements, drawn faintly.
    pub dots: Vec<(f64, f64)>,
    /// Whether the line's points have no marks.
    pub smooth: bool,
}

/// Curves with a title and labelled axes.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    pub title: String,
    pub x: String,
    pub y: String,
    /// Whether x and y are logarithmic.
    pub log: [bool; 2],
    pub series: Vec<Series>,
}

const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 320.0;
const LEFT: f64 = 78.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 56.0;
/// Width of a letter in the legend, on the high side.
const LETTER: f64 = 7.0;

impl Plot {
    /// The SVG. A series without a drawable point is in the legend only.
    pub fn svg(&self) -> String {
        let longest = self.series.iter().map(|s| s.name.chars().count()).max().unwrap_or(0);
        let total = [LEFT + WIDTH + 48.0 + longest as f64 * LETTER, TOP + HEIGHT + BOTTOM];
        let axes = [0, 1].map(|i| Axis::over(&self.values(i), self.log[i]));
        let place = |p: &(f64, f64)| {
            let (x, y) = (axes[0].share(p.0)?, axes[1].share(p.1)?);
            Some((LEFT + x * WIDTH, TOP + (1.0 - y) * HEIGHT))
        };
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0}\" height=\"{1:.0}\" viewBox=\"0 0 {0:.0} \
             {1:.0}\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" \
             fill=\"#fff\"/>\n",
            total[0], total[1]
        );
        self.frame(&axes, &mut out);
        for (i, series) in self.series.iter().enumerate() {
            let colour = COLOURS[i % COLOURS.len()];
            // The second round of colours is dashed, its points are hollow.
            let again = i >= COLOURS.len();
            let dash = if again { " stroke-dasharray=\"6 3\"" } else { "" };
            let fill = if again { "#fff" } else { colour };
            for (x, y) in series.dots.iter().filter_map(place) {
                push(
                    &mut out,
                    format_args!(
                        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2\" fill=\"{colour}\" opacity=\"0.4\"/>"
                    ),
                );
            }
            let points: Vec<(f64, f64)> = series.line.iter().filter_map(place).collect();
            let path: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
            push(
                &mut out,
                format_args!(
                    "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\"{dash}/>",
                    path.join(" ")
                ),
            );
            if !series.smooth {
                for (x, y) in points {
                    push(
                        &mut out,
                        format_args!(
                            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{fill}\" stroke=\"{colour}\" \
                             stroke-width=\"1.5\"/>"
                        ),
                    );
                }
            }
            let (x, y) = (LEFT + WIDTH + 14.0, TOP + 10.0 + 20.0 * i as f64);
            push(
                &mut out,
                format_args!(
                    "<path d=\"M{x} {y}h20\" stroke=\"{colour}\" stroke-width=\"2.5\"{dash}/><circle \
                     cx=\"{}\" cy=\"{y}\" r=\"3.5\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.5\"/><text x=\"{}\" y=\"{}\">{}</text>",
                    x + 10.0,
                    x + 26.0,
                    y + 4.0,
                    escape(&series.name)
                ),
            );
        }
        out.push_str("</svg>\n");
        out
    }

    fn values(&self, axis: usize) -> Vec<f64> {
        let points = self.series.iter().flat_map(|s| s.line.iter().chain(&s.dots));
        points.map(|p| if axis == 0 { p.0 } else { p.1 }).collect()
    }

    fn frame(&self, axes: &[Axis; 2], out: &mut String) {
        let (right, bottom) = (LEFT + WIDTH, TOP + HEIGHT);
        for (value, labelled) in axes[0].ticks() {
            let Some(x) = axes[0].share(value).map(|s| LEFT + s * WIDTH) else { continue };
            let shade = if labelled { "#ccc" } else { "#eee" };
            push(out, format_args!("<path d=\"M{x:.1} {TOP}V{bottom}\" stroke=\"{shade}\"/>"));
            if labelled {
                push(
                    out,
                    format_args!(
                        "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                        bottom + 17.0,
                        number(value)
                    ),
                );
            }
        }
        for (value, labelled) in axes[1].ticks() {
            let Some(y) = axes[1].share(value).map(|s| TOP + (1.0 - s) * HEIGHT) else { continue };
            let shade = if labelled { "#ccc" } else { "#eee" };
            push(out, format_args!("<path d=\"M{LEFT} {y:.1}H{right}\" stroke=\"{shade}\"/>"));
            if labelled {
                push(
                    out,
                    format_args!(
                        "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                        LEFT - 7.0,
                        y + 4.0,
                        number(value)
                    ),
                );
            }
        }
        push(
            out,
            format_args!(
                "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"none\" stroke=\"#333\"/>"
            ),
        );
        let (cx, cy) = (LEFT + WIDTH / 2.0, TOP + HEIGHT / 2.0);
        push(
            out,
            format_args!(
                "<text x=\"{cx}\" y=\"24\" text-anchor=\"middle\" font-size=\"15\" font-weight=\"bold\">{}</text>",
                escape(&self.title)
            ),
        );
        push(
            out,
            format_args!(
                "<text x=\"{cx}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                bottom + 40.0,
                escape(&self.x)
            ),
        );
        push(
            out,
            format_args!(
                "<text transform=\"translate(18 {cy}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
                escape(&self.y)
            ),
        );
    }
}

fn push(out: &mut String, line: std::fmt::Arguments<'_>) {
    // Writing to a String does not fail.
    let _never = writeln!(out, "{line}");
}

struct Axis {
    low: f64,
    high: f64,
    log: bool,
}

impl Axis {
    /// An axis over the drawable values, with a little room at both ends.
    fn over(values: &[f64], log: bool) -> Self {
        let drawable = values.iter().copied().filter(|v| v.is_finite() && (!log || *v > 0.0));
        let map = |v: f64| if log { v.log10() } else { v };
        let (mut low, mut high) =
            drawable.map(map).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let least = if log { 0.5 } else { 1e-9 };
        let room = (0.06 * (high - low)).max(if high - low < least { least / 2.0 } else { 0.0 });
        let floor = if !log && low >= 0.0 { 0.0 } else { low - room };
        Self { low: floor, high: high + room, log }
    }

    fn share(&self, value: f64) -> Option<f64> {
        let v = if self.log { value.log10() } else { value };
        v.is_finite()
            .then(|| (v - self.low) / (self.high - self.low))
            .filter(|s| (-1e-9..=1.0 + 1e-9).contains(s))
    }

    /// Values with a grid line, and whether they are labelled.
    fn ticks(&self) -> Vec<(f64, bool)> {
        let span = self.high - self.low;
        if !self.log {
            let step = nice(span / 6.0);
            let first = (self.low / step).ceil() as i64;
            let last = (self.high / step).floor() as i64;
            return (first..=last).map(|i| (i as f64 * step, true)).collect();
        }
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        decades
            .flat_map(|d| (1..10).map(move |m| (d, m)))
            .map(|(d, m)| {
                let labelled = match m {
                    1 => true,
                    2 | 5 => span < 2.6,
                    3 | 7 => span < 0.8,
                    _ => false,
                };
                (f64::from(m) * 10f64.powi(d), labelled)
            })
            .filter(|(v, _)| (self.low..=self.high).contains(&v.log10()))
            .collect()
    }
}

/// 1, 2 or 5 times a power of ten, near `step`.
fn nice(step: f64) -> f64 {
    let decade = 10f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * decade >= step * 0.999).unwrap_or(10.0);
    factor * decade
}

/// A short label.
fn number(v: f64) -> String {
    if v == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e5).contains(&v.abs()) {
        return format!("{v:.0e}");
    }
    let text = format!("{v:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_inside_the_axis() {
        let axis = Axis::over(&[0.012, 3.0], true);
        let labels: Vec<f64> = axis.ticks().iter().filter(|t| t.1).map(|t| t.0).collect();
        assert!(labels.contains(&0.1) && labels.contains(&1.0) && labels.len() <= 10, "{labels:?}");
        let axis = Axis::over(&[0.0, 7.3], false);
        assert_eq!(axis.ticks().iter().map(|t| t.0).collect::<Vec<_>>(), [0.0, 2.0, 4.0, 6.0]);
        assert_eq!(Axis::over(&[], true).ticks().len(), 11);
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.0, 0.05, 2.0, 1e-5, 1e6].map(number), ["0", "0.05", "2", "1e-5", "1e6"]);
    }

    #[test]
    fn undrawable_values_leave_the_rest() {
        let series = Series {
            name: "a<b".into(),
            line: vec![(1.0, 0.0), (2.0, 1.0), (4.0, f64::NAN)],
            ..Series::default()
        };
        let svg = Plot { log: [true; 2], series: vec![series], ..Plot::default() }.svg();
        assert!(svg.contains("a&lt;b") && !svg.contains("NaN") && !svg.contains("inf"));
    }
}

//! Transforms that can only turn.

use super::props::Props;
use crate::diagnostic::Diagnostic;
use crate::ir::Transform;

/// `to_world` of an environment, which can only turn and mirror it.
pub(super) fn turned(props: &mut Props<'_>) -> Transform {
    let given = props.transform("to_world");
    let lengths = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        .map(|axis| given.vector(axis).iter().map(|x| x * x).sum::<f64>().sqrt());
    let kept = given.is_similarity() && lengths.iter().all(|length| (length - 1.0).abs() < 1e-3);
    if kept || !lengths.iter().all(|length| length.is_normal()) {
        return given;
    }
    let text = "`to_world` scales the environment, which can only be turned: the scale is left out";
    let place = props.entry("to_world").map(|entry| entry.name_span);
    let help =
        "Mitsuba looks scaled directions up in one way and samples them in another: its picture is no truth";
    props.problems.push(Diagnostic::warning(text, place).help(help));
    given.after(&Transform::scale(lengths.map(|length| 1.0 / length)))
}

//! Volumes: what media and phase functions take for values that vary in space.

use super::object::{Class, ObjectIndex, Value};
use super::props::Props;
use super::reader::Reader;
use super::version::Dialect;
use crate::ir::{
    ColorInput, ColorSlot, GridSamples, Volume, VolumeData, VolumeFile, VolumeFilter, VolumeFormat,
    VolumeGrid, WrapMode,
};
use crate::plugin::{Plugin, read, unsupported};

type ReadVolume = for<'a> fn(&mut Reader<'a>, &mut Props<'a>) -> Option<Volume>;

pub(super) const VOLUMES: &[Plugin<ReadVolume>] = &[
    read("constvolume", constant),
    read("gridvolume", grid),
    // Of what it wraps, computed when it is asked for.
    read("volcache", cached),
    unsupported("hgridvolume"),
];

impl<'a> Reader<'a> {
    /// A number, colour or volume; `None` when it is not given or was reported.
    pub fn volume(&mut self, props: &mut Props<'a>, name: &'static str) -> Option<Volume> {
        let entry = props.entry(name)?;
        match entry.value {
            Value::Object(index) if self.objects[index].class == Class::Volume => self.nested_volume(index),
            Value::Vector(direction) => Some(Volume::Direction(direction)),
            _ => match self.color_value(props, entry, ColorSlot::Unbounded)? {
                ColorInput::Color(color) => Some(Volume::Constant(color)),
                ColorInput::Texture(_) => props.wrong(entry, "a number, colour or volume"),
            },
        }
    }

    pub fn volume_or(&mut self, props: &mut Props<'a>, name: &'static str, default: f64) -> Volume {
        self.volume(props, name).unwrap_or(Volume::number(default))
    }

    fn nested_volume(&mut self, index: ObjectIndex) -> Option<Volume> {
        let reader = self.plugin(VOLUMES, index, "the default is used")?;
        let mut props = self.props(index);
        let volume = reader(self, &mut props);
        self.finish(props);
        volume
    }
}

fn constant<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Volume> {
    // The bounds of a constant matter to the medium alone.
    props.ignore(&["to_world"]);
    let name = if props.has("color") && !props.has("value") { "color" } else { "value" };
    // `color` is what the first version of Mitsuba 2 called it.
    Some(reader.volume_or(props, name, 1.0))
}

fn grid<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Volume> {
    let path = reader.asset(props, "volume");
    let to_world = props.transform("to_world");
    if to_world.inverse().is_none() {
        props.complain("to_world", "`to_world` flattens the volume: it has no inverse");
    }
    let old = reader.dialect == Dialect::Old;
    let corners = [props.triple("min"), props.triple("max")];
    let filters = [("trilinear", VolumeFilter::Trilinear), ("nearest", VolumeFilter::Nearest)];
    let filter = props.choice("filter_type", VolumeFilter::Trilinear, &filters);
    let wraps = [("clamp", WrapMode::Clamp), ("repeat", WrapMode::Repeat), ("mirror", WrapMode::Mirror)];
    let wrap = props.choice("wrap_mode", if old { WrapMode::Zero } else { WrapMode::Clamp }, &wraps);
    let of_file = props.boolean("use_grid_bbox", old);
    // Colours are as stored in RGB; the others say how the grid is kept.
    props.ignore(&["raw", "accel", "max_value", "send_data"]);
    let bounds = match corners {
        [Some(min), Some(max)] if old => Some([min, max]),
        _ if of_file => None,
        _ => Some([[0.0; 3], [1.0; 3]]),
    };
    if let Some([min, max]) = bounds
        && (0..3).any(|i| min[i] >= max[i])
    {
        props.complain("max", "the box from `min` to `max` is empty");
    }
    Some(Volume::Grid(VolumeGrid {
        data: VolumeData::File(VolumeFile { path: path?, format: VolumeFormat::Vol }),
        bounds,
        to_world,
        filter,
        wrap,
        samples: if old { GridSamples::Corners } else { GridSamples::Centers },
    }))
}

fn cached<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Volume> {
    props.ignore(&["block_size", "voxel_width", "mem_limit", "to_world"]);
    let Some(nested) = props.only_child(Class::Volume) else {
        props.needs("a nested volume");
        return None;
    };
    reader.nested_volume(nested.index)
}

//! Random media of what each language can say.

use std::path::PathBuf;

use caustica_formats::ir::{
    Cloud, Coefficients, Color, EmitterKind, GridSamples, GridValues, Id, Medium, MediumEmission,
    MediumInterface, Origin, Phase, Scene, Shape, ShapeKind, Transform, Volume, VolumeData, VolumeFile,
    VolumeFilter, VolumeFormat, VolumeGrid, WrapMode,
};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

use crate::random::{Language, albedo, between, light_color, transform, triple};

/// A file of one channel that random scenes refer to, and one of three.
pub const FILES: [(&str, i32); 2] = [("smoke.vol", 1), ("tint.vol", 3)];

/// Mitsuba's VOL file of 2 × 2 × 2 points.
pub fn vol(channels: i32) -> Vec<u8> {
    let head = [1, 2, 2, 2, channels].into_iter().flat_map(i32::to_le_bytes);
    let corners = [-1.0f32, 0.0, 0.0, 1.0, 1.0, 3.0].into_iter();
    let values = (0..8 * channels).map(|i| i as f32 / 32.0);
    b"VOL\x03".iter().copied().chain(head).chain(corners.chain(values).flat_map(f32::to_le_bytes)).collect()
}

/// Media, and numbers that say where they are.
pub type Filling = (Vec<Medium>, Vec<usize>);

pub fn filling(language: Language) -> impl Strategy<Value = Filling> {
    (vec(medium(language), 0..3), vec(any::<usize>(), 4))
}

/// Fills parts of `scene`.
pub fn fill(scene: &mut Scene, language: Language, (media, picks): Filling) {
    let mut ids = vec![None];
    for (i, medium) in media.into_iter().enumerate() {
        ids.push(Some(scene.media.push(Medium { name: Some(format!("medium {i}")), ..medium })));
    }
    let mut number = 0;
    let mut next = || -> Option<Id<Medium>> {
        number += 1;
        ids[picks[number % picks.len()].wrapping_add(number * 7) % ids.len()]
    };
    let groups: Vec<_> = scene.groups.iter().map(|(id, _)| id).collect();
    // What is placed many times has its media where it is defined.
    let placed = |shape: &&mut Shape| !matches!(shape.kind, ShapeKind::Instance { .. });
    for shape in scene.shapes.iter_mut().filter(placed) {
        shape.media = interface(language, [next(), next()]);
    }
    for id in groups {
        for shape in &mut scene.groups[id].shapes {
            shape.media = interface(language, [next(), next()]);
        }
    }
    scene.sensors[0].medium = next();
    for emitter in &mut scene.emitters {
        if matches!(emitter.kind, EmitterKind::Point { .. } | EmitterKind::Spot { .. }) {
            emitter.medium = next();
        }
    }
}

/// As its language's reader has it: Mitsuba's is there where a side is named, pbrt's where the sides differ.
fn interface(language: Language, [interior, exterior]: [Option<Id<Medium>>; 2]) -> Option<MediumInterface> {
    let there = match language {
        Language::Mitsuba => interior.is_some() || exterior.is_some(),
        Language::Pbrt => interior != exterior,
    };
    there.then_some(MediumInterface { interior, exterior })
}

fn medium(language: Language) -> impl Strategy<Value = Medium> {
    let parts = (contents(language), between(0.25, 8.0), phase(language));
    parts.prop_map(|((coefficients, density, emission), scale, phase)| {
        // A cloud has its own factor.
        let scale = if matches!(density, Some(Volume::Cloud(_))) { 1.0 } else { scale };
        let (name, origin, orientation) = (None, Origin(None), None);
        Medium { name, origin, coefficients, density, scale, emission, phase, orientation }
    })
}

type Contents = (Coefficients, Option<Volume>, Option<MediumEmission>);

fn contents(language: Language) -> BoxedStrategy<Contents> {
    match language {
        Language::Mitsuba => mitsuba(),
        Language::Pbrt => pbrt(),
    }
}

fn constant() -> impl Strategy<Value = Volume> + Clone {
    albedo().prop_map(Volume::Constant)
}

/// Of a file.
fn stored((name, _): (&'static str, i32)) -> impl Strategy<Value = Volume> {
    let wraps = vec![WrapMode::Clamp, WrapMode::Repeat, WrapMode::Mirror];
    (transform(), any::<bool>(), any::<bool>(), proptest::sample::select(wraps)).prop_map(
        move |(to_world, own_box, nearest, wrap)| {
            let file = VolumeFile { path: PathBuf::from(name), format: VolumeFormat::Vol };
            Volume::Grid(VolumeGrid {
                data: VolumeData::File(file),
                bounds: (!own_box).then_some([[0.0; 3], [1.0; 3]]),
                to_world,
                filter: if nearest { VolumeFilter::Nearest } else { VolumeFilter::Trilinear },
                wrap,
                samples: GridSamples::Centers,
            })
        },
    )
}

fn grid(values: GridValues, bounds: [[f64; 3]; 2], to_world: Transform, wrap: WrapMode) -> Volume {
    Volume::Grid(VolumeGrid {
        data: VolumeData::Inline(values.into()),
        bounds: Some(bounds),
        to_world,
        filter: VolumeFilter::Trilinear,
        wrap,
        samples: GridSamples::Centers,
    })
}

fn one_value() -> GridValues {
    GridValues { resolution: [1; 3], channels: 1, values: vec![1.0] }
}

fn mitsuba() -> BoxedStrategy<Contents> {
    let even = (constant(), constant())
        .prop_map(|(sigma_t, albedo)| (Coefficients::Extinction { sigma_t, albedo }, None, None));
    let smoke = (stored(FILES[0]), prop_oneof![constant(), stored(FILES[1])].boxed())
        .prop_map(|(sigma_t, albedo)| (Coefficients::Extinction { sigma_t, albedo }, None, None));
    // A constant extinction of a heterogeneous medium ends at the unit cube of its transform.
    let cube = (constant(), constant(), transform()).prop_map(|(sigma_t, albedo, to_world)| {
        let bounds = grid(one_value(), [[0.0; 3], [1.0; 3]], to_world, WrapMode::Clamp);
        let Volume::Grid(bounds) = bounds else { unreachable!("a grid was made") };
        let density = Volume::Grid(VolumeGrid { filter: VolumeFilter::Nearest, ..bounds });
        (Coefficients::Extinction { sigma_t, albedo }, Some(density), None)
    });
    prop_oneof![2 => even, 1 => smoke, 1 => cube].boxed()
}

fn pbrt() -> BoxedStrategy<Contents> {
    let parts =
        || (constant(), constant()).prop_map(|(sigma_a, sigma_s)| Coefficients::Parts { sigma_a, sigma_s });
    let glow = |scale: Volume| {
        option::of(light_color().prop_filter("light", |color| *color != Color::Rgb([0.0; 3]))).prop_map(
            move |radiance| {
                let scale = scale.clone();
                radiance.map(|r| MediumEmission::Radiance { radiance: Volume::Constant(r), scale })
            },
        )
    };
    let even = (parts(), glow(Volume::number(2.0))).prop_map(|(parts, emission)| (parts, None, emission));
    let place = || (triple(-2.0, -1.0), triple(1.0, 2.0), transform());
    let values = || vec(0.0f32..4.0, 12);
    let smoke = (parts(), values(), place()).prop_map(|(parts, values, (p0, p1, to_world))| {
        let values = GridValues { resolution: [2, 3, 2], channels: 1, values };
        (parts, Some(grid(values, [p0, p1], to_world, WrapMode::Zero)), None)
    });
    let tinted = (values(), values(), place()).prop_map(|(a, s, (p0, p1, to_world))| {
        let of = |values| {
            let values = GridValues { resolution: [2, 1, 2], channels: 3, values };
            grid(values, [p0, p1], to_world, WrapMode::Zero)
        };
        (Coefficients::Parts { sigma_a: of(a), sigma_s: of(s) }, None, None)
    });
    let cloud = (parts(), triple(0.5, 4.0), place()).prop_map(|(parts, numbers, (p0, p1, to_world))| {
        let [density, wispiness, frequency] = numbers;
        let cloud = Cloud { density, wispiness, frequency, bounds: [p0, p1], to_world };
        (parts, Some(Volume::Cloud(cloud)), None)
    });
    prop_oneof![2 => even, 1 => smoke, 1 => tinted, 1 => cloud].boxed()
}

fn phase(language: Language) -> BoxedStrategy<Phase> {
    let plain = prop_oneof![
        Just(Phase::Isotropic),
        between(-0.9, 0.9).prop_map(|g| if g == 0.0 {
            Phase::Isotropic
        } else {
            Phase::HenyeyGreenstein { g }
        })
    ];
    if language == Language::Pbrt {
        return plain.boxed();
    }
    let own = prop_oneof![
        Just(Phase::Rayleigh),
        vec(between(0.125, 4.0), 2..5).prop_map(|values| Phase::Tabulated { values }),
    ];
    let single = prop_oneof![plain, own].boxed();
    let blend = (between(0.0, 1.0), single.clone(), single.clone()).prop_map(|(weight, first, second)| {
        Phase::Blend { weight: Volume::number(weight), parts: Box::new([first, second]) }
    });
    prop_oneof![3 => single, 1 => blend].boxed()
}

//! Opacity of shapes: a mask around whatever they are made of.

use std::borrow::Cow;

use caustica_formats::ir::{self, BsdfKind, Color, ColorInput};

/// The scene with every shape's own opacity moved into its BSDF. Shapes that emit keep theirs too: it cuts
/// their light as it cuts them.
pub fn into_masks(scene: &ir::Scene) -> Cow<'_, ir::Scene> {
    let mut groups = scene.groups.iter().map(|(_, g)| g);
    let any = |shapes: &[ir::Shape]| shapes.iter().any(|s| s.alpha.is_some());
    if !any(&scene.shapes) && !groups.any(|g| any(&g.shapes)) {
        return Cow::Borrowed(scene);
    }
    let mut scene = scene.clone();
    let ids: Vec<_> = scene.groups.iter().map(|(id, _)| id).collect();
    let (bsdfs, groups) = (&mut scene.bsdfs, &mut scene.groups);
    scene.shapes.iter_mut().for_each(|s| mask(s, bsdfs));
    for id in ids {
        groups[id].shapes.iter_mut().for_each(|s| mask(s, bsdfs));
    }
    Cow::Owned(scene)
}

fn mask(shape: &mut ir::Shape, bsdfs: &mut ir::Arena<ir::Bsdf>) {
    let Some(opacity) = shape.alpha.clone() else { return };
    if shape.emission.is_none() {
        shape.alpha = None;
    }
    let origin = shape.origin;
    let mut add = |kind| bsdfs.push(ir::Bsdf { name: None, origin, kind });
    let nested = shape.bsdf.unwrap_or_else(|| {
        // What a shape without BSDF is made of.
        let gray = if shape.emission.is_some() { 0.0 } else { 0.5 };
        add(BsdfKind::Diffuse { reflectance: ColorInput::Color(Color::Gray(gray)) })
    });
    shape.bsdf = Some(add(BsdfKind::Mask { opacity, nested }));
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use caustica_formats::files::Memory;
    use caustica_formats::{ReadOptions, read_scene};

    use super::*;

    #[test]
    fn an_opacity_becomes_a_mask_around_the_default_material() {
        let text = "<scene version='3.0.0'><shape type='cube'/><shape type='disk'/></scene>";
        let files = Memory([("s.xml".into(), text.as_bytes().to_vec())].into_iter().collect());
        let mut scene =
            read_scene(&files, Path::new("s.xml"), &ReadOptions::default()).expect("it is a scene").scene;
        assert!(matches!(into_masks(&scene), Cow::Borrowed(_)));
        scene.shapes[1].alpha = Some(ir::FloatInput::Value(0.25));
        let masked = into_masks(&scene);
        assert_eq!(masked.shapes[0], scene.shapes[0]);
        let BsdfKind::Mask { opacity, nested } = &masked.bsdfs[masked.shapes[1].bsdf.expect("a mask")].kind
        else {
            panic!("no mask");
        };
        assert_eq!(*opacity, ir::FloatInput::Value(0.25));
        assert!(matches!(masked.bsdfs[*nested].kind, BsdfKind::Diffuse { .. }));
        assert_eq!(masked.shapes[1].alpha, None);
    }
}

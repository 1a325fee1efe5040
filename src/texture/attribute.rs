use super::{Pattern, Site, Textures};
use crate::math::Color;
use crate::spectrum::rgb;

/// Values stored with the meshes that show them (Mitsuba's `mesh_attribute`).
#[derive(Clone, Debug)]
pub struct MeshAttribute {
    /// As the mesh file calls it, with `vertex_` or `face_` before it.
    pub name: String,
    /// Factor of all values.
    pub scale: f32,
    /// By shape; `None` for those that do not use it.
    pub by_shape: Vec<Option<Values>>,
}

/// Values of one mesh.
#[derive(Clone, Debug)]
pub struct Values {
    /// The three vertices of every triangle; empty when the values are those of the triangles.
    pub corners: Vec<[u32; 3]>,
    /// By vertex or by triangle.
    pub values: Vec<[f32; 3]>,
}

impl MeshAttribute {
    /// Hands over the values that shape number `shape` shows.
    pub fn give(&mut self, shape: u32, values: Values) {
        let shape = shape as usize;
        if self.by_shape.len() <= shape {
            self.by_shape.resize(shape + 1, None);
        }
        self.by_shape[shape] = Some(values);
    }
}

impl Pattern for MeshAttribute {
    /// Linear over a triangle, or constant on it; black where there is no mesh.
    fn eval(&self, _textures: &Textures, at: &Site) -> Color {
        let on = &at.on;
        let Some(Some(mesh)) = self.by_shape.get(on.shape as usize) else { return Color::ZERO };
        let vertex = |i: usize| mesh.values.get(i).map_or(Color::ZERO, |v| rgb(*v));
        let triangle = on.triangle as usize;
        let value = match mesh.corners.get(triangle) {
            Some(t) => {
                let [a, b, c] = t.map(|i| vertex(i as usize));
                let [second, third] = on.weights;
                a * (1.0 - second - third) + b * second + c * third
            }
            None => vertex(triangle),
        };
        value * self.scale
    }

    fn bytes(&self) -> usize {
        let of = |v: &Values| size_of_val(v.corners.as_slice()) + size_of_val(v.values.as_slice());
        self.by_shape.iter().flatten().map(of).sum()
    }

    fn is_attribute(&self) -> bool {
        true
    }

    fn may_leave_unit(&self, _: &Textures) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::OnMesh;
    use super::*;
    use crate::math::Vec2;

    #[test]
    fn vertices_are_interpolated_and_faces_are_not() {
        let values = vec![[1.0; 3], [2.0; 3], [4.0; 3]];
        let mut t = MeshAttribute { name: "vertex_x".into(), scale: 2.0, by_shape: Vec::new() };
        t.give(1, Values { corners: vec![[0, 1, 2], [2, 1, 0]], values: values.clone() });
        t.give(2, Values { corners: Vec::new(), values });
        let at = |shape, triangle| {
            let on = OnMesh { shape, triangle, weights: [0.25, 0.5] };
            t.eval(&Textures::default(), &Site { on, ..Site::flat(Vec2::ZERO) }).lanes()[0]
        };
        assert_eq!(at(1, 0), 2.0 * (0.25 + 0.5 + 2.0));
        assert_eq!(at(1, 1), 2.0 * (1.0 + 0.5 + 0.5));
        assert_eq!(at(2, 1), 4.0);
        assert_eq!([at(0, 0), at(7, 0)], [0.0; 2]);
    }
}

use crate::math::{Frame, Vec2, Vec3};

/// A place from which a rectangular picture is thrown along local +Z; as in a camera, local +X is on the
/// left of the picture and +Y on top.
#[derive(Clone, Debug)]
pub struct Frustum {
    /// Where the light comes from, in the world.
    pub position: Vec3,
    /// Orthonormal, possibly mirroring.
    pub axes: Frame,
    /// Half of the picture's size at distance 1.
    pub half: Vec2,
}

/// Light towards a point: where it passes the picture.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// Unit, towards the light.
    pub dir: Vec3,
    /// Square of the distance.
    pub d2: f32,
    /// Cosine to the axis.
    pub cos: f32,
    /// On the picture, v = 0 at the top.
    pub uv: Vec2,
}

impl Frustum {
    /// Area of the picture at distance 1.
    pub fn area(&self) -> f32 {
        4.0 * self.half.x * self.half.y
    }

    /// Solid angle of the part of the picture between two corners.
    pub fn solid_angle(&self, a: Vec2, b: Vec2) -> f64 {
        let plane = |uv: Vec2| ((Vec2::ONE - uv * 2.0) * self.half).as_dvec2();
        let (a, b) = (plane(a), plane(b));
        // Of the rectangle from the axis to (x, y) at distance 1.
        let corner = |x: f64, y: f64| (x * y).atan2((1.0 + x * x + y * y).sqrt());
        (corner(a.x, a.y) - corner(a.x, b.y) - corner(b.x, a.y) + corner(b.x, b.y)).abs()
    }

    /// `None` outside the frustum.
    pub fn toward(&self, p: Vec3) -> Option<Beam> {
        let d = self.position - p;
        let d2 = d.length_squared();
        let dir = d / d2.sqrt();
        let local = self.axes.to_local(-dir);
        if !(d2 > 0.0 && local.z > 0.0) {
            return None;
        }
        let on_plane = Vec2::new(local.x, local.y) / (local.z * self.half);
        let uv = (Vec2::ONE - on_plane) * 0.5;
        let inside = uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all();
        inside.then_some(Beam { dir, d2, cos: local.z, uv })
    }

    /// Unit direction of travel through a point of the picture, and its cosine to the axis. An area on the
    /// picture covers a solid angle of cos³ times its size at distance 1.
    pub fn through(&self, uv: Vec2) -> (Vec3, f32) {
        let p = (Vec2::ONE - uv * 2.0) * self.half;
        let local = Vec3::new(p.x, p.y, 1.0).normalize();
        (self.axes.to_world(local), local.z)
    }
}

use super::{Param, Pattern, Site, Textures, UvTransform};
use crate::math::Color;

/// Lines of half-width `line` (in uv) along the borders of unit cells (Mitsuba 0.6 `gridtexture`).
#[derive(Clone, Debug)]
pub struct Grid {
    /// Cells, lines.
    pub colors: [Param; 2],
    /// Half of the width of a line, in uv.
    pub line: f32,
    /// From the uv of the surface to that of the cells.
    pub to_uv: UvTransform,
}

impl Pattern for Grid {
    fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let t = self.to_uv.apply(at.uv);
        let near = |x: f32| (x - x.round()).abs() < self.line;
        textures.eval(self.colors[usize::from(near(t.x) || near(t.y))], at)
    }

    fn inputs(&self) -> Vec<Param> {
        self.colors.to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;

    const IDENTITY: UvTransform = UvTransform { u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] };

    #[test]
    fn grid_lines_run_along_the_borders_of_cells() {
        let grid = Grid { colors: [Param::gray(0.2), Param::gray(0.8)], line: 0.1, to_uv: IDENTITY };
        for (u, v, expected) in
            [(0.5, 0.5, 0.2), (0.05, 0.5, 0.8), (0.95, 0.5, 0.8), (3.5, -2.04, 0.8), (1.2, 1.2, 0.2)]
        {
            assert_eq!(
                grid.eval(&Textures::default(), &Site::flat(Vec2::new(u, v))).lanes()[0],
                expected,
                "{u} {v}"
            );
        }
    }
}

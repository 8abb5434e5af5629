//! Parallel projection of points onto a canvas, and what hides what on it.

/// The direction that a picture is seen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewDirection {
    /// Angle about +z from +x towards +y of the direction to the eye, degrees.
    pub azimuth_deg: f64,
    /// Angle of the direction to the eye above the xy-plane, degrees.
    pub elevation_deg: f64,
}

impl Default for ViewDirection {
    /// From the side, a little above: shows the fold of a tape spring along x and both its arms.
    fn default() -> Self {
        Self { azimuth_deg: -62.0, elevation_deg: 24.0 }
    }
}

/// Projects along one direction, in pixels once it is fitted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    right: [f64; 3],
    up: [f64; 3],
    to_eye: [f64; 3],
    /// Pixels per mm.
    pub(super) scale: f64,
    /// Canvas place of the projected origin, pixels.
    offset: [f64; 2],
}

/// A point on the canvas: right and down in pixels, and nearness to the eye in mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projected {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) near: f64,
}

impl Projected {
    /// Half way to another point.
    pub(super) fn middle(&self, other: &Self) -> Self {
        let half = |one: f64, other: f64| 0.5 * (one + other);
        Self { x: half(self.x, other.x), y: half(self.y, other.y), near: half(self.near, other.near) }
    }
}

impl Camera {
    /// Looks from `direction` so that `points` fill the width of the box `[left, top, width, most height]` (or its
    /// height, where that is less). Gives the camera and the height that the points take, pixels.
    pub(super) fn fitted(
        direction: ViewDirection,
        points: impl Iterator<Item = [f64; 3]>,
        frame: [f64; 4],
    ) -> (Self, f64) {
        let (sin_a, cos_a) = direction.azimuth_deg.to_radians().sin_cos();
        let (sin_e, cos_e) = direction.elevation_deg.to_radians().sin_cos();
        let mut camera = Self {
            right: [-sin_a, cos_a, 0.0],
            up: [-sin_e * cos_a, -sin_e * sin_a, cos_e],
            to_eye: [cos_e * cos_a, cos_e * sin_a, sin_e],
            scale: 1.0,
            offset: [0.0, 0.0],
        };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points.map(|point| camera.project(point)) {
            for (k, value) in [point.x, point.y].into_iter().enumerate() {
                low[k] = low[k].min(value);
                high[k] = high[k].max(value);
            }
        }
        let [left, top, width, most_height] = frame;
        let size = [0, 1].map(|k| (high[k] - low[k]).max(f64::MIN_POSITIVE));
        camera.scale = (width / size[0]).min(most_height / size[1]);
        let spare = width - camera.scale * size[0];
        camera.offset = [left + 0.5 * spare - camera.scale * low[0], top - camera.scale * low[1]];
        (camera, camera.scale * size[1])
    }

    /// The place of `point` (mm) in the picture.
    pub(super) fn project(&self, point: [f64; 3]) -> Projected {
        Projected {
            x: self.offset[0] + self.scale * dot(self.right, point),
            y: self.offset[1] - self.scale * dot(self.up, point),
            near: dot(self.to_eye, point),
        }
    }

    /// How much light falls on a face with the given normal (of any length, to either side), from 0 to 1; the lamp
    /// stands above the left shoulder.
    pub(super) fn light(&self, normal: [f64; 3]) -> f64 {
        let length = dot(normal, normal).sqrt();
        let lamp = [0, 1, 2].map(|k| 0.78 * self.to_eye[k] + 0.55 * self.up[k] - 0.3 * self.right[k]);
        if length > 0.0 { (dot(normal, lamp) / length / dot(lamp, lamp).sqrt()).abs() } else { 1.0 }
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// For every pixel the nearest face.
pub(super) struct DepthBuffer {
    width: usize,
    height: usize,
    nearest: Vec<(f64, u32)>,
}

/// No face here.
const NO_FACE: u32 = u32::MAX;

impl DepthBuffer {
    /// An empty canvas.
    pub(super) fn new(width: usize, height: usize) -> Self {
        Self { width, height, nearest: vec![(f64::NEG_INFINITY, NO_FACE); width * height] }
    }

    /// Draws a triangle that belongs to `face`.
    pub(super) fn triangle(&mut self, face: u32, [a, b, c]: [Projected; 3]) {
        let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        if area == 0.0 {
            return;
        }
        let from = |values: [f64; 3]| values.into_iter().fold(f64::INFINITY, f64::min).floor().max(0.0) as usize;
        let to = |values: [f64; 3], limit: usize| {
            (values.into_iter().fold(f64::NEG_INFINITY, f64::max).ceil().max(0.0) as usize).min(limit)
        };
        for row in from([a.y, b.y, c.y])..to([a.y, b.y, c.y], self.height) {
            for column in from([a.x, b.x, c.x])..to([a.x, b.x, c.x], self.width) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let of_b = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / area;
                let of_c = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / area;
                if of_b < 0.0 || of_c < 0.0 || of_b + of_c > 1.0 {
                    continue;
                }
                let near = a.near + of_b * (b.near - a.near) + of_c * (c.near - a.near);
                let pixel = &mut self.nearest[row * self.width + column];
                if near > pixel.0 {
                    *pixel = (near, face);
                }
            }
        }
    }

    /// Whether a point that lies on the surface is seen: nothing in its pixel is nearer by more than `tolerance` mm, or
    /// the surface is seen at its depth in a pixel beside it (where it is steep, one pixel spans more than that).
    pub(super) fn sees(&self, point: Projected, tolerance: f64) -> bool {
        self.around(point).enumerate().any(|(beside, (near, _))| {
            let nothing_before = near <= point.near + tolerance;
            nothing_before && (beside == 0 || near >= point.near - tolerance)
        })
    }

    /// The face seen at a point, or beside it.
    pub(super) fn face(&self, point: Projected) -> Option<usize> {
        self.around(point).map(|(_, face)| face).find(|face| *face != NO_FACE).map(|face| face as usize)
    }

    /// The face that each pixel shows, of those that show one.
    pub(super) fn faces(&self) -> impl Iterator<Item = usize> {
        self.nearest.iter().filter(|(_, face)| *face != NO_FACE).map(|(_, face)| *face as usize)
    }

    /// The pixel of a point and its neighbours that are on the canvas.
    fn around(&self, point: Projected) -> impl Iterator<Item = (f64, u32)> {
        const OFFSETS: [(f64, f64); 5] = [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
        OFFSETS.into_iter().filter_map(move |(right, down)| {
            let (column, row) = ((point.x + right).floor(), (point.y + down).floor());
            let inside = column >= 0.0 && row >= 0.0 && column < self.width as f64 && row < self.height as f64;
            inside.then(|| self.nearest[row as usize * self.width + column as usize])
        })
    }
}

//! Algebra of vectors of three components, as far as kernels need it.

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scaled(factor: f64, a: [f64; 3]) -> [f64; 3] {
    [factor * a[0], factor * a[1], factor * a[2]]
}

/// The unit vector along x, y or z (`c` 0, 1 or 2).
pub(crate) fn basis_vector(c: usize) -> [f64; 3] {
    [0, 1, 2].map(|k| f64::from(u8::from(k == c)))
}

pub(crate) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// The unit normal of a surface with these tangents.
pub(crate) fn unit_normal([a1, a2]: [[f64; 3]; 2]) -> [f64; 3] {
    let normal = cross(a1, a2);
    scaled(1.0 / norm(normal), normal)
}

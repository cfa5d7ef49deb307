//! One triangle: its closest point, where a line hits it, and the solid angle it fills.

use std::f64::consts::TAU;

use crate::mesh::Vector;

/// The corners of a triangle, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corners(pub [Vector; 3]);

impl Corners {
    pub(super) fn middle(&self) -> Vector {
        let [a, b, c] = self.0;
        (a + b + c) / 3.0
    }

    /// Along the normal, as long as the area in mm².
    pub(super) fn area_vector(&self) -> Vector {
        let [a, b, c] = self.0;
        (b - a).cross(&(c - a)) * 0.5
    }

    /// The other side in front.
    pub(super) fn reversed(&self) -> Corners {
        let [a, b, c] = self.0;
        Corners([a, c, b])
    }

    /// Six times the volume of the tetrahedron with a point.
    pub(super) fn volume_with(&self, point: &Vector) -> f64 {
        let [a, b, c] = self.0.map(|corner| corner - point);
        a.dot(&b.cross(&c))
    }

    /// Source: Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
    pub(super) fn closest(&self, point: &Vector) -> Vector {
        let [a, b, c] = self.0;
        let (ab, ac, ap) = (b - a, c - a, point - a);
        let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
        if d1 <= 0.0 && d2 <= 0.0 {
            return a;
        }
        let bp = point - b;
        let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
        if d3 >= 0.0 && d4 <= d3 {
            return b;
        }
        let vc = d1 * d4 - d3 * d2;
        if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            return a + ab * (d1 / (d1 - d3));
        }
        let cp = point - c;
        let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
        if d6 >= 0.0 && d5 <= d6 {
            return c;
        }
        let vb = d5 * d2 - d1 * d6;
        if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            return a + ac * (d2 / (d2 - d6));
        }
        let va = d3 * d6 - d5 * d4;
        if va <= 0.0 && d4 >= d3 && d5 >= d6 {
            return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
        }
        let sum = va + vb + vc;
        a + ab * (vb / sum) + ac * (vc / sum)
    }

    /// Where on its way from `start`, as a part from 0 to 1, a segment meets the triangle, borders included.
    ///
    /// Source: Möller, Trumbore, Fast, minimum storage ray-triangle intersection, Journal of Graphics Tools 2 (1997) 21-28.
    pub(super) fn hit(&self, start: &Vector, way: &Vector) -> Option<f64> {
        let [a, b, c] = self.0;
        let (ab, ac, from) = (b - a, c - a, start - a);
        let across = way.cross(&ac);
        let determinant = ab.dot(&across);
        let u = from.dot(&across) / determinant;
        let over = from.cross(&ab);
        let v = way.dot(&over) / determinant;
        let part = ac.dot(&over) / determinant;
        // None of this holds for a segment in the plane, whose determinant is zero and quotients are no numbers.
        let is_on = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        (is_on && (0.0..=1.0).contains(&part) && determinant != 0.0).then_some(part)
    }
}

/// How a segment passes a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Passage {
    Beside,
    /// The winding number beyond is this much more.
    Through(f64),
    /// Too near an edge, an end of the segment or its plane to be certain.
    Doubtful,
}

/// What is too near, of the lengths of the triangle and the segment.
const DOUBTFUL: f64 = 1e-9;

impl Corners {
    /// How the winding number changes along a segment by this triangle: by one more where its back is left in front.
    pub(super) fn passage(&self, start: &Vector, way: &Vector) -> Passage {
        let [a, b, c] = self.0;
        let (ab, ac, from) = (b - a, c - a, start - a);
        let across = way.cross(&ac);
        let determinant = ab.dot(&across);
        let u = from.dot(&across) / determinant;
        let over = from.cross(&ab);
        let v = way.dot(&over) / determinant;
        let part = ac.dot(&over) / determinant;
        let least = u.min(v).min(1.0 - u - v).min(part).min(1.0 - part);
        if determinant.abs() <= DOUBTFUL * way.norm() * ab.norm() * ac.norm() || least.is_nan() {
            Passage::Doubtful
        } else if least < -DOUBTFUL {
            Passage::Beside
        } else if least <= DOUBTFUL {
            Passage::Doubtful
        } else {
            Passage::Through(determinant.signum())
        }
    }
}

/// A sum of solid angles, as a product of complex numbers whose argument is half the sum, and how often that went around.
#[derive(Clone, Copy, Debug)]
pub(super) struct SolidAngles {
    real: f64,
    imaginary: f64,
    turns: f64,
}

impl Default for SolidAngles {
    fn default() -> Self {
        SolidAngles { real: 1.0, imaginary: 0.0, turns: 0.0 }
    }
}

impl SolidAngles {
    /// Adds the solid angle of a triangle; one in whose plane the point lies adds nothing.
    pub(super) fn add(&mut self, corners: &Corners, point: &Vector) {
        let [a, b, c] = corners.0.map(|corner| corner - point);
        let [la, lb, lc] = [a, b, c].map(|side| side.norm());
        let sine = a.dot(&b.cross(&c));
        let cosine = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
        let size = sine.abs() + cosine.abs();
        if sine == 0.0 || !size.is_normal() {
            return;
        }
        let (x, y) = (cosine / size, sine / size);
        let real = self.real * x - self.imaginary * y;
        let imaginary = self.real * y + self.imaginary * x;
        // Half the angle is less than pi, so that the product passes the negative real axis at most once.
        if sine > 0.0 && self.imaginary >= 0.0 && imaginary < 0.0 {
            self.turns += 1.0;
        } else if sine < 0.0 && self.imaginary < 0.0 && imaginary >= 0.0 {
            self.turns -= 1.0;
        }
        // Between 1/2 and 1 of what it was, brought back so that it never vanishes.
        let size = real.abs() + imaginary.abs();
        (self.real, self.imaginary) = (real / size, imaginary / size);
    }

    /// The sum over 4 pi.
    pub(super) fn winding(&self) -> f64 {
        (self.imaginary.atan2(self.real) + TAU * self.turns) / TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Corners {
        Corners([
            Vector::new(1.0, 0.2, -0.1),
            Vector::new(3.0, 0.5, 0.4),
            Vector::new(1.4, 2.5, 1.0),
        ])
    }

    fn places() -> impl Iterator<Item = Vector> {
        let part = |n: usize, step: f64| (n as f64 * step).fract() * 6.0 - 1.5;
        (1..500)
            .map(move |n| Vector::new(part(n, 0.618_034), part(n, 0.754_878), part(n, 0.569_84)))
    }

    #[test]
    fn no_place_of_a_triangle_is_nearer_than_its_closest_point() {
        let Corners([a, b, c]) = triangle();
        for point in places() {
            let found = (triangle().closest(&point) - point).norm();
            let mut least = f64::INFINITY;
            for i in 0..=60 {
                for j in 0..=60 - i {
                    let place =
                        a + (b - a) * (f64::from(i) / 60.0) + (c - a) * (f64::from(j) / 60.0);
                    least = least.min((place - point).norm());
                }
            }
            assert!(found <= least + 1e-12 && found > least - 0.05, "{point}: {found} {least}");
        }
    }

    #[test]
    fn a_segment_through_a_place_of_the_triangle_hits_it_there() {
        let Corners([a, b, c]) = triangle();
        for (n, start) in places().enumerate() {
            let (u, v) = (0.05 + 0.9 * (n as f64 * 0.371).fract(), 0.1);
            let place = a + (b - a) * (u * (1.0 - v)) + (c - a) * v;
            let way = (place - start) * 1.6;
            let part = triangle().hit(&start, &way).unwrap();
            assert!((part - 1.0 / 1.6).abs() < 1e-9, "{part}");
            assert_eq!(triangle().hit(&start, &((place - start) * 0.9)), None);
        }
        let aside = Vector::new(9.0, 9.0, 9.0);
        assert_eq!(triangle().hit(&aside, &Vector::x()), None);
        assert_eq!(triangle().hit(&a, &Vector::zeros()), None);
    }

    #[test]
    fn the_octants_of_a_cube_share_the_solid_angle_and_turns_are_counted() {
        let corner = |n: usize| {
            Vector::repeat(1.0)
                - Vector::new(
                    2.0 * (n & 1) as f64,
                    2.0 * (n >> 1 & 1) as f64,
                    2.0 * (n >> 2 & 1) as f64,
                )
        };
        // Twelve outward triangles; corner 0 is (1, 1, 1), bit 0 turns x.
        let quads =
            [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]];
        let triangles: Vec<Corners> = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .map(|three| Corners(three.map(corner)))
            .collect();
        for (point, winding) in
            [(Vector::new(0.3, -0.2, 0.9), 1.0), (Vector::new(1.3, 0.0, 0.0), 0.0)]
        {
            for times in [1, 2, 5] {
                let mut angles = SolidAngles::default();
                for _ in 0..times {
                    triangles.iter().for_each(|triangle| angles.add(triangle, &point));
                }
                let wanted = winding * f64::from(times);
                assert!((angles.winding().abs() - wanted).abs() < 1e-12, "{}", angles.winding());
                let reversed = |angles: &mut SolidAngles| {
                    triangles.iter().for_each(|triangle| angles.add(&triangle.reversed(), &point));
                };
                (0..times).for_each(|_| reversed(&mut angles));
                assert!(angles.winding().abs() < 1e-12);
            }
        }
        let mut face = SolidAngles::default();
        triangles[..2].iter().for_each(|triangle| face.add(triangle, &Vector::zeros()));
        assert!((face.winding().abs() - 1.0 / 6.0).abs() < 1e-12);
    }
}

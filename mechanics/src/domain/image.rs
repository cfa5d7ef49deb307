//! Soft tissue of a CT: where a cubic B-spline of its Hounsfield units lies between air and bone.
//!
//! f = min((I_s - skin) / s, (bone - I_b) / s, distance to the border of the image and to the limits). I_s and I_b are one
//! smoothed image but where that would mislead: pieces apart from the head are emptied in I_s, cavities of bone and the
//! lining of airways beside bone are filled in I_b (see `compartments`), so that no sheet of partial volume is left there.
//! Values are mirrored about the threshold, so that the boundary of what stays does not move.

use rayon::prelude::*;

use super::channels::{channels, tissue_box, world_box};
use super::compartments::{Compartment, Division, compartments};
use super::flood::place;
use super::image_error::ImageDomainError;
use super::image_options::ImageOptions;
use super::left_out::{LeftOut, left_out};
use super::limit::{Limit, LimitError, Limits};
use super::nearest_boundary::{Reach, Slope, Slopes, nearest};
use super::region_map::RegionMap;
use super::scanned_skin::{Replaced, ScannedSkin, replaced};
use super::smoothed::{Smoothed, divided, nothing};
use super::thickness::{Level, Surroundings, surroundings};
use super::{Boundary, Coverage, Crossing, Domain, root};
use crate::image::{CubicSpline, ImageVolume, SplineRanges, SplineValue, Voxels};
use crate::mesh::Vector;
use nalgebra::Matrix3;

/// A CT as a body to mesh.
#[derive(Clone, Debug)]
pub struct ImageDomain {
    spline: CubicSpline<2>,
    ranges: SplineRanges<2>,
    origin: Vector,
    to_index: Matrix3<f64>,
    skin: f64,
    bone: f64,
    /// Values for each mm, so that members are of a size.
    scale: f64,
    limits: Limits,
    thickness: Vec<f32>,
    airway: Vec<bool>,
    bounds: (Vector, Vector),
    left_out: LeftOut,
    bone_outside: f64,
    /// The longest step to a neighbouring voxel, in mm.
    step: f64,
    /// Of a label map.
    regions: Option<RegionMap>,
}

/// What the grid of an image knows.
pub(super) struct ImageGrid {
    pub division: Division,
    /// The first and the last voxel along each axis that tissue may reach into.
    pub tissue: [[usize; 3]; 2],
    pub left_out: LeftOut,
    pub surroundings: Surroundings,
}

/// The surroundings of voxels by their compartments and by the values for skin and for bone.
pub(super) fn surroundings_of(
    all: &[Compartment],
    division: &Division,
    [skin, bone]: &[Vec<f32>; 2],
) -> Surroundings {
    let skin = Level { values: skin, level: division.skin };
    let bone = Level { values: bone, level: division.bone };
    surroundings(all, division, skin, bone)
}

/// The parts of f, of which the least is f.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Member {
    Skin,
    Bone,
    Cut,
}

const MEMBERS: [Member; 3] = [Member::Skin, Member::Bone, Member::Cut];

/// What coefficients must be beyond a threshold by to be surely beyond it, of the scale: rounding of sums is far less.
const SURELY: f64 = 1e-5;
/// More voxels are not looked at to tell how much tissue was cut off.
const MOST_SAMPLES: usize = 1 << 20;
/// Largest value of f, so that it is finite for points infinitely far.
const LARGEST: f64 = 1e12;

impl ImageDomain {
    pub fn new(image: &ImageVolume, options: &ImageOptions) -> Result<Self, ImageDomainError> {
        ImageDomain::of_values(divided(image, options)?, None, options)
    }

    /// The same body with a skin that was scanned by itself where this covers it.
    pub fn with_skin(
        image: &ImageVolume,
        options: &ImageOptions,
        skin: &ScannedSkin,
    ) -> Result<Self, ImageDomainError> {
        let mut divided = divided(image, options)?;
        let Smoothed { image, values, division, all } = &divided;
        let Replaced { values: for_skin, bone_outside } =
            replaced(image, values, all, (division, skin))?;
        let bone_outside = bone_outside as f64 * image.voxel_volume();
        divided.all = compartments(&for_skin, division);
        let domain = ImageDomain::of_values(divided, Some(for_skin), options)?;
        Ok(ImageDomain { bone_outside, ..domain })
    }

    /// Of values for skin of their own, where there are such.
    fn of_values(
        divided: Smoothed,
        for_skin: Option<Vec<f32>>,
        options: &ImageOptions,
    ) -> Result<Self, ImageDomainError> {
        let Smoothed { image, values: for_bone, division, all } = divided;
        let Division { size, skin, bone, .. } = division;
        let values = for_skin.unwrap_or_else(|| for_bone.clone());
        let tissue = tissue_box(&all, size).ok_or_else(|| nothing(&image, &values, options))?;
        let has_body = |voxel: usize| f64::from(values[voxel]) >= skin;
        let left_out = left_out(&image, &all, has_body);
        ImageDomainError::refuse_scattered(&left_out)?;
        let channels = channels([values, for_bone], &all, [skin, bone]);
        let surroundings = surroundings_of(&all, &division, &channels);
        let spline = CubicSpline::new(size, channels);
        let divided = ImageGrid { division, tissue, left_out, surroundings };
        ImageDomain::of_spline(&image, spline, divided, &options.limits)
    }

    /// Depth within the head and all that it encloses: positive there, airways too, negative in the air around it; on its skin the
    /// values of the image, smoothed, less the threshold of skin.
    pub fn head(
        image: &ImageVolume,
        options: &ImageOptions,
    ) -> Result<ImageVolume, ImageDomainError> {
        let Smoothed { image, values, division, all } = divided(image, options)?;
        let above = |(&value, &compartment): (&f32, &Compartment)| {
            let above = value - division.skin as f32;
            match compartment {
                Compartment::OuterAir => above.min(-1.0),
                Compartment::InnerAir
                | Compartment::Tissue
                | Compartment::Bone
                | Compartment::Cavity
                | Compartment::Lining => above.max(1.0),
            }
        };
        let values = Voxels::F32(values.iter().zip(&all).map(above).collect());
        Ok(ImageVolume::new(image.size(), *image.placement(), values)?)
    }

    /// Of a spline of the values for skin and for bone.
    pub(super) fn of_spline(
        image: &ImageVolume,
        spline: CubicSpline<2>,
        divided: ImageGrid,
        limits: &[Limit],
    ) -> Result<Self, ImageDomainError> {
        let ImageGrid { division, tissue, left_out, surroundings } = divided;
        let mut limits = Limits::new(limits)?;
        limits.push_border(image);
        let span = division.bone - division.skin;
        Ok(ImageDomain {
            ranges: SplineRanges::new(&spline),
            spline,
            origin: image.placement().origin,
            to_index: *image.to_index(),
            skin: division.skin,
            bone: division.bone,
            scale: if span > 0.0 { span } else { 1.0 },
            limits,
            thickness: surroundings.thickness,
            airway: surroundings.airway,
            bounds: world_box(image, tissue),
            left_out,
            bone_outside: 0.0,
            step: division.spacing.iter().copied().fold(0.0, f64::max),
            regions: None,
        })
    }

    /// The same tissue in regions.
    #[must_use]
    pub(super) fn with_regions(self, regions: RegionMap) -> Self {
        ImageDomain { regions: Some(regions), ..self }
    }

    /// How far the value for bone of each voxel is above that from which on there is bone.
    pub fn bone_values(&self) -> Vec<f32> {
        let size = self.spline.size();
        let above = |voxel: usize| {
            let place = place(voxel, size).map(|index| index as f64);
            (self.spline.at(place)[1] - self.bone) as f32
        };
        (0..size.iter().product()).into_par_iter().map(above).collect()
    }

    /// Bone outside a skin that was scanned by itself, in mm³.
    pub fn bone_outside(&self) -> f64 {
        self.bone_outside
    }

    /// The parts that are disconnected from the body and count as air.
    pub fn left_out(&self) -> &LeftOut {
        &self.left_out
    }

    /// In voxels.
    fn place(&self, point: &Vector) -> [f64; 3] {
        (self.to_index * (point - self.origin)).into()
    }

    fn members(&self, point: &Vector) -> [f64; 3] {
        let [skin, bone] = self.spline.at(self.place(point));
        let cut = self.limits.value(point);
        [(skin - self.skin) / self.scale, (self.bone - bone) / self.scale, cut]
    }

    fn slopes(&self, point: &Vector) -> [Slope; 3] {
        let [skin, bone] = self.spline.with_gradient(self.place(point));
        let cut = self.limits.with_gradient(point);
        let slope = |spline: SplineValue, sign: f64, threshold: f64| Slope {
            value: sign * (spline.value - threshold) / self.scale,
            gradient: self.to_index.tr_mul(&Vector::from(spline.gradient)) * (sign / self.scale),
        };
        let cut = Slope { value: cut.value, gradient: cut.gradient };
        [slope(skin, 1.0, self.skin), slope(bone, -1.0, self.bone), cut]
    }

    fn boundary_at(&self, point: &Vector) -> Boundary {
        let members = self.members(point);
        let least = MEMBERS.into_iter().zip(members).reduce(|a, b| if b.1 < a.1 { b } else { a });
        match least.map_or(Member::Skin, |(member, _)| member) {
            Member::Bone => Boundary::Bone,
            Member::Cut => Boundary::Cut,
            Member::Skin if self.airway[self.nearest_voxel(point)] => Boundary::Airway,
            Member::Skin => Boundary::Skin,
        }
    }

    /// The tissue of voxels that limits leave out, islands and pockets included, in mm³. Of a large image every other or
    /// third voxel along each axis is looked at.
    pub fn cut_off(&self, limits: &[Limit]) -> Result<f64, LimitError> {
        let limits = Limits::new(limits)?;
        let size = self.spline.size();
        let stride = (1..).find(|stride| {
            size.iter().map(|n| n.div_ceil(*stride)).product::<usize>() <= MOST_SAMPLES
        });
        let stride = stride.unwrap_or(1);
        let to_place = self.to_index.try_inverse().unwrap_or_default();
        let count = size.map(|n| n.div_ceil(stride));
        let is_cut_off = |&sample: &usize| {
            let [nx, ny, _] = count;
            let index = [sample % nx, sample / nx % ny, sample / (nx * ny)];
            let index = Vector::from(index.map(|index| (index * stride) as f64));
            let point = self.origin + to_place * index;
            let [skin, bone, _] = self.members(&point);
            limits.value(&point) <= 0.0 && skin > 0.0 && bone > 0.0
        };
        let samples: usize = count.iter().product();
        let cut_off = (0..samples).into_par_iter().filter(is_cut_off).count();
        Ok((cut_off * stride.pow(3)) as f64 * to_place.determinant().abs())
    }

    fn nearest_voxel(&self, point: &Vector) -> usize {
        let place = self.place(point);
        let [x, y, z] = self.index(place.map(|index| index + 0.5));
        let [nx, ny, _] = self.spline.size();
        (z * ny + y) * nx + x
    }

    /// Whole numbers of voxels, within the image.
    fn index(&self, place: [f64; 3]) -> [usize; 3] {
        let size = self.spline.size();
        std::array::from_fn(|axis| (place[axis].max(0.0) as usize).min(size[axis] - 1))
    }
}

impl Domain for ImageDomain {
    fn bounds(&self) -> (Vector, Vector) {
        self.bounds
    }

    fn coverage(&self, centre: &Vector, radius: f64) -> Coverage {
        let cut = self.limits.value(centre);
        if cut <= -radius {
            return Coverage::Outside;
        }
        let place = self.place(centre);
        let half: [f64; 3] = std::array::from_fn(|axis| self.to_index.row(axis).norm() * radius);
        let corner = |sign: f64| std::array::from_fn(|axis| place[axis] + sign * half[axis]);
        let range = self.ranges.over(corner(-1.0), corner(1.0));
        let [low, high] = [range.low, range.high].map(|values| values.map(f64::from));
        let slack = SURELY * self.scale;
        if high[0] < self.skin - slack || low[1] > self.bone + slack {
            Coverage::Outside
        } else if low[0] > self.skin + slack && high[1] < self.bone - slack && cut > radius {
            Coverage::Inside
        } else {
            Coverage::Mixed
        }
    }

    fn value(&self, point: &Vector) -> f64 {
        let [skin, bone, cut] = self.members(point);
        skin.min(bone).min(cut).clamp(-LARGEST, LARGEST)
    }

    fn crossing(&self, inside: &Vector, outside: &Vector) -> Crossing {
        let point = root::between(inside, outside, |point| self.value(point));
        Crossing { point, boundary: self.boundary_at(&point) }
    }

    fn projection(&self, point: &Vector, boundary: Boundary) -> Vector {
        let wanted = match boundary {
            Boundary::Skin | Boundary::Airway => 0,
            Boundary::Bone => 1,
            Boundary::Cut => 2,
        };
        let reach = Reach { step: self.step, far: 3.0 * self.step };
        let slopes = |point: &Vector| {
            let slopes = self.slopes(point);
            let [a, b] = [slopes[(wanted + 1) % 3], slopes[(wanted + 2) % 3]];
            Slopes { wanted: slopes[wanted], bound: if a.value < b.value { a } else { b } }
        };
        let found = nearest(point, reach, slopes, |point| self.members(point)[wanted]);
        found.unwrap_or(*point)
    }

    fn thickness(&self, point: &Vector) -> f64 {
        let place = self.place(point);
        let size = self.spline.size();
        let base = self.index(place);
        let mut sum = 0.0;
        for corner in 0..8 {
            let mut weight = 1.0;
            let index: [usize; 3] = std::array::from_fn(|axis| {
                let part = (place[axis] - base[axis] as f64).clamp(0.0, 1.0);
                let is_far = corner >> axis & 1 == 1;
                weight *= if is_far { part } else { 1.0 - part };
                (base[axis] + usize::from(is_far)).min(size[axis] - 1)
            });
            let thickness = self.thickness[(index[2] * size[1] + index[1]) * size[0] + index[0]];
            sum += if weight > 0.0 { weight * f64::from(thickness) } else { 0.0 };
        }
        sum
    }

    fn regions(&self) -> usize {
        self.regions.as_ref().map_or(1, RegionMap::count)
    }

    fn region(&self, point: &Vector) -> u8 {
        self.regions.as_ref().map_or(0, |regions| regions.at(self.place(point)))
    }

    fn meeting(&self, [one, other]: &[Vector; 2], between: [u8; 2]) -> Vector {
        let Some(regions) = &self.regions else { return (one + other) * 0.5 };
        root::between(one, other, |point| regions.lead(self.place(point), between))
    }

    fn interface(&self, point: &Vector, between: [u8; 2]) -> Vector {
        let Some(regions) = &self.regions else { return *point };
        regions.interface(point, between, &|point| self.place(point), &self.to_index)
    }
}

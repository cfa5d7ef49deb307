//! Segments in scans made in code.

use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::Vector;
use mechanics::osteotomy::teeth::{ENAMEL_HU, Teeth};
use mechanics::osteotomy::{
    BoneImage, Cut, CutSide, Extent, LabelError, Labelled, Osteotomy, Owner, Plane, SegmentRule,
    Side, label,
};

/// Voxels of 1 x 1 x 2 mm; the first is at the origin.
pub fn scan(size: [usize; 3], value: impl Fn(Vector) -> f64) -> ImageVolume {
    let steps = [Vector::x(), Vector::y(), Vector::z() * 2.0];
    let placement = Placement { origin: Vector::zeros(), steps };
    let count = size.iter().product();
    let values = (0..count).map(|n: usize| {
        let place = [n % size[0], n / size[0] % size[1], n / (size[0] * size[1])];
        value(Vector::new(place[0] as f64, place[1] as f64, place[2] as f64 * 2.0)) as f32
    });
    ImageVolume::new(size, placement, Voxels::F32(values.collect())).unwrap()
}

pub fn plane(point: [f64; 3], normal: [f64; 3]) -> Plane {
    Plane::new(Vector::from(point), Vector::from(normal)).unwrap()
}

pub fn segment(name: &str, sides: &[(usize, Side)], seeds: &[[f64; 3]]) -> SegmentRule {
    SegmentRule {
        name: name.to_owned(),
        sides: sides.iter().map(|&(cut, side)| CutSide { cut, side }).collect(),
        seeds: seeds.iter().map(|&seed| Vector::from(seed)).collect(),
    }
}

fn parted(image: &ImageVolume, cuts: Vec<Cut>, segments: Vec<SegmentRule>) -> Labelled {
    labelled(image, cuts, segments).unwrap()
}

fn labelled(
    image: &ImageVolume,
    cuts: Vec<Cut>,
    segments: Vec<SegmentRule>,
) -> Result<Labelled, LabelError> {
    label(&BoneImage { image, threshold: 200.0 }, &Osteotomy::new(cuts, segments).unwrap())
}

/// Bone of 1000 HU with x in 2..=17, y in 2..=11 and z in 4..=30.
fn block() -> ImageVolume {
    scan([20, 14, 20], |x| {
        let inside = (2.0..=17.0).contains(&x.x) && (2.0..=11.0).contains(&x.y);
        if inside && (4.0..=30.0).contains(&x.z) { 1000.0 } else { 0.0 }
    })
}

#[test]
fn a_plane_parts_a_block_and_the_parts_are_the_whole() {
    let cut = Cut::unbounded("cut", plane([0.0, 0.0, 15.0], [0.0, 0.0, 1.0]));
    let [upper, lower] = [Side::Above, Side::Below].map(|side| segment("part", &[(0, side)], &[]));
    let found = parted(&block(), vec![cut.clone()], vec![lower.clone()]);
    assert_eq!(found.segments[0].voxels, 16 * 10 * 6);
    assert_eq!(found.segments[0].volume_mm3, 16.0 * 10.0 * 6.0 * 2.0);
    assert_eq!(found.segments[0].centre, Vector::new(9.5, 6.5, 9.0));
    let other = SegmentRule { name: "other".to_owned(), ..upper };
    let both = parted(&block(), vec![cut], vec![lower, other]);
    assert_eq!(both.segments[0], found.segments[0]);
    assert_eq!(both.segments[1].voxels, 16 * 10 * 8);
    let [contact] = &both.contacts[..] else { panic!("{:?}", both.contacts) };
    assert_eq!(contact.between, [Owner::Segment(0), Owner::Segment(1)]);
    assert_eq!((contact.cut, contact.faces, contact.area_mm2), (Some(0), 160, 160.0));
    assert_eq!(contact.centre, Vector::new(9.5, 6.5, 15.0));
}

#[test]
fn the_area_of_an_oblique_cut_is_that_of_the_plane() {
    let normal = Vector::new(0.2, -0.3, 1.0);
    let cut = Cut::unbounded("cut", plane([9.5, 6.5, 13.0], normal.into()));
    let found = parted(&block(), vec![cut], vec![segment("part", &[(0, Side::Below)], &[])]);
    let [contact] = &found.contacts[..] else { panic!("{:?}", found.contacts) };
    let wanted = 160.0 * normal.norm();
    assert!((contact.area_mm2 / wanted - 1.0).abs() < 0.03, "{} {wanted}", contact.area_mm2);
    assert_eq!(contact.between, [Owner::Rest, Owner::Segment(0)]);
}

#[test]
fn a_saw_of_a_width_leaves_sawdust_between_the_parts() {
    let plane = plane([0.0, 0.0, 15.0], [0.0, 0.0, 1.0]);
    let cut = Cut::new("cut", plane, None, 4.0).unwrap();
    let found = parted(&block(), vec![cut], vec![segment("part", &[(0, Side::Below)], &[])]);
    let sawn = (0..20 * 14 * 20).filter(|&v| found.labels.owner(v) == Some(Owner::Sawn)).count();
    // Voxels at 14 and 16 mm are within 2 mm of the plane.
    assert_eq!((found.segments[0].voxels, sawn), (16 * 10 * 5, 16 * 10 * 2));
    let parts: Vec<_> = found.contacts.iter().map(|c| (c.between, c.cut)).collect();
    assert!(parts.contains(&([Owner::Sawn, Owner::Segment(0)], Some(0))), "{parts:?}");
    assert!(parts.iter().all(|(between, _)| *between != [Owner::Rest, Owner::Segment(0)]));
}

/// Steps along x, at z = 13 up to x = 9.5 and at z = 21 beyond, sawn from y = 0 as deep as is given.
fn stepped(depth: f64) -> Vec<Cut> {
    let line = [[0.0, 0.0, 13.0], [9.5, 0.0, 13.0], [9.5, 0.0, 21.0], [20.0, 0.0, 21.0]];
    let line = line.map(Vector::from);
    Cut::chained("step", &line, Vector::y() * depth, 0.0, 0).unwrap()
}

/// The bone below the steps. Above the normals of the pieces, along x (or z) times y, is where z grows and x falls.
fn below_the_steps() -> SegmentRule {
    let sides = [0, 1, 2].map(|piece| (piece, Side::Below));
    segment("part", &sides, &[[4.0, 6.0, 6.0]])
}

#[test]
fn a_stepped_cut_parts_what_lies_below_its_steps() {
    let found = parted(&block(), stepped(14.0), vec![below_the_steps()]);
    // 8 columns of voxels up to 12 mm, and 8 up to 20 mm.
    assert_eq!(found.segments[0].voxels, 10 * (8 * 5 + 8 * 9));
    assert_eq!(found.bridges, []);
    for (cut, wanted) in [(0, 8.0 * 10.0), (1, 8.0 * 10.0), (2, 8.0 * 10.0)] {
        let at = found.contacts.iter().find(|contact| contact.cut == Some(cut)).unwrap();
        assert_eq!(at.area_mm2, wanted, "{cut}: {:?}", found.contacts);
    }
    assert!(found.contacts.iter().all(|contact| contact.cut.is_some()), "{:?}", found.contacts);
}

#[test]
fn a_stepped_cut_that_is_walked_the_other_way_is_refused() {
    let line = [[20.0, 0.0, 21.0], [9.5, 0.0, 21.0], [9.5, 0.0, 13.0], [0.0, 0.0, 13.0]];
    for kerf in [0.0, 1.0] {
        let cuts =
            Cut::chained("step", &line.map(Vector::from), Vector::y() * 14.0, kerf, 0).unwrap();
        let refused = labelled(&block(), cuts, vec![below_the_steps()]).unwrap_err();
        let LabelError::LineTurned { segment, cut } = &refused else { panic!("{refused}") };
        assert_eq!((segment.as_str(), cut.as_str()), ("part", "step, piece 1"));
    }
}

#[test]
fn a_stepped_cut_that_is_not_deep_enough_leaves_a_bridge() {
    let found = parted(&block(), stepped(8.0), vec![below_the_steps()]);
    let bridged: Vec<usize> = found.bridges.iter().map(|bridge| bridge.cut).collect();
    assert_eq!(bridged, [0, 1, 2]);
    // Behind y = 8 three or four rows of voxels of eight columns, or four layers of the riser, hang together, and nothing else.
    for bridge in &found.bridges {
        let rows = bridge.faces / if bridge.cut == 1 { 4 } else { 8 };
        let area = if bridge.cut == 1 { 2.0 } else { 1.0 } * bridge.faces as f64;
        assert!((3..=4).contains(&rows), "{bridge:?}");
        assert_eq!(bridge.area_mm2, area, "{bridge:?}");
        assert!(bridge.centre.y > 9.0, "{bridge:?}");
    }
}

#[test]
fn a_segment_that_comes_around_a_disc_is_named_although_next_to_it_lies_other_bone() {
    // Two bars, x from 2 to 17, joined by a wall at x up to 4, and a pillar on the lower one that ends below the upper one.
    let bone = scan([20, 14, 20], |x| {
        let within = |low: [f64; 2], high: [f64; 2]| {
            (low[0]..=high[0]).contains(&x.x) && (low[1]..=high[1]).contains(&x.z)
        };
        let bars = within([2.0, 4.0], [17.0, 8.0]) || within([2.0, 22.0], [17.0, 30.0]);
        let is_bone = bars || within([2.0, 4.0], [4.0, 30.0]) || within([10.0, 4.0], [12.0, 18.0]);
        if is_bone && (2.0..=11.0).contains(&x.y) { 1000.0 } else { 0.0 }
    });
    let disc = |radius| {
        let plane = plane([11.0, 6.5, 13.0], [0.0, 0.0, 1.0]);
        Cut::new("cut", plane, Some(Extent::Disc { radius }), 0.0).unwrap()
    };
    let below = || vec![segment("part", &[(0, Side::Below)], &[[8.0, 6.0, 6.0]])];
    // The disc parts all of the pillar, and the bone above it is no segment's; the wall leads around.
    let around = parted(&bone, vec![disc(6.0)], below());
    assert!(around.segments[0].centre.z > 13.0, "{:?}", around.segments[0]);
    let [bridge] = &around.bridges[..] else { panic!("{:?}", around.bridges) };
    assert_eq!((bridge.segment, bridge.cut, bridge.faces), (0, 0, 3 * 10));
    assert!((bridge.centre - Vector::new(3.0, 6.5, 13.0)).norm() < 1e-9, "{bridge:?}");
    // All of the plane leaves the lower bar.
    let whole = parted(&bone, vec![disc(40.0)], below());
    assert!(whole.segments[0].centre.z < 13.0 && whole.bridges.is_empty(), "{whole:?}");
}

#[test]
fn a_line_whose_corners_lie_on_centres_of_voxels_parts_the_bone_without_a_bridge() {
    // Corners in x from 9 to 10 and in z from 12 to 14, where centres lie at whole x and even z.
    for x in [9.0, 9.5, 10.0] {
        for z in [12.0, 13.0, 14.0] {
            for (turn, depth) in [(false, 14.0), (true, -14.0)] {
                let line = [[0.0, 0.0, z], [x, 0.0, z], [x, 0.0, z + 8.0], [20.0, 0.0, z + 8.0]];
                let mut line = line.map(Vector::from);
                if turn {
                    line.reverse();
                }
                // Sawn from before the bone, or walked the other way and sawn from behind it.
                line.iter_mut().for_each(|point| point.y = if turn { 13.0 } else { 0.0 });
                let cuts = Cut::chained("step", &line, Vector::y() * depth, 0.0, 0).unwrap();
                let found = parted(&block(), cuts, vec![below_the_steps()]);
                assert_eq!(found.bridges, [], "{x} {z} {turn}");
                let columns = |from: f64, to: f64| {
                    (2..=17).filter(|&at| f64::from(at) > from && f64::from(at) < to).count()
                };
                let layers = |to: f64| (2..=15).filter(|&at| 2.0 * f64::from(at) < to).count();
                // What lies on the line goes with either side.
                let least = 10 * (columns(0.0, x) * layers(z) + columns(x, 20.0) * layers(z + 8.0));
                let most = least + 10 * (16 + layers(z + 8.0));
                let voxels = found.segments[0].voxels;
                assert!(
                    (least..=most).contains(&voxels),
                    "{x} {z} {turn}: {least} {voxels} {most}"
                );
                assert!(found.contacts.iter().all(|contact| contact.cut.is_some()));
            }
        }
    }
}

/// Two blocks that touch at a neck of 2 x 2 voxels between x = 9 and x = 11, dimmer than the blocks.
fn touching(neck: f64) -> ImageVolume {
    scan([21, 12, 8], |x| {
        let inside = (1.0..=10.0).contains(&x.y) && (2.0..=12.0).contains(&x.z);
        let middle = (5.0..=6.0).contains(&x.y) && (6.0..=8.0).contains(&x.z);
        match x.x as usize {
            1..=8 | 12..=19 if inside => 1000.0,
            9..=11 if middle => neck,
            _ => 0.0,
        }
    })
}

#[test]
fn bones_that_touch_are_parted_where_their_contact_is_dimmest_and_it_is_reported() {
    let segments = || {
        vec![segment("one", &[], &[[4.0, 5.0, 6.0]]), segment("other", &[], &[[16.0, 5.0, 6.0]])]
    };
    let found = parted(&touching(400.0), vec![], segments());
    // 8 x 10 x 6 voxels each, and the twelve of the neck.
    assert_eq!(found.segments[0].voxels + found.segments[1].voxels, 2 * 480 + 12);
    assert!(found.segments.iter().all(|segment| segment.voxels >= 480), "{:?}", found.segments);
    let [contact] = &found.contacts[..] else { panic!("{:?}", found.contacts) };
    assert_eq!((contact.cut, contact.faces), (None, 4));
    assert!((contact.centre.y - 5.5).abs() < 1e-9 && (contact.centre.x - 10.0).abs() < 2.0);
    assert!(found.labels == parted(&touching(400.0), vec![], segments()).labels);
    let alone = parted(&touching(0.0), vec![], segments());
    assert!(alone.contacts.is_empty());
}

#[test]
fn a_segment_whose_largest_piece_is_anothers_asks_for_a_seed() {
    let segments = vec![segment("one", &[], &[[4.0, 5.0, 6.0]]), segment("other", &[], &[])];
    let error = labelled(&touching(400.0), vec![], segments).unwrap_err();
    assert_eq!(
        error,
        LabelError::NeedsSeed { segment: "other".to_owned(), other: "one".to_owned() }
    );
}

#[test]
fn a_cut_that_ends_within_the_bone_is_named_with_its_bridge() {
    let cut = |radius: f64| {
        let plane = plane([2.0, 6.5, 15.0], [0.0, 0.0, 1.0]);
        Cut::new("short", plane, Some(Extent::Disc { radius }), 0.0).unwrap()
    };
    let seeds = [[9.0, 6.0, 8.0]];
    let rule = || vec![segment("part", &[(0, Side::Below)], &seeds)];
    let whole = parted(&block(), vec![cut(30.0)], rule());
    assert_eq!((whole.segments[0].voxels, whole.bridges.len()), (960, 0));
    // What the disc parted from it is no bone of its own side.
    assert_eq!(whole.segments[0].left.voxels, 0);
    // A radius of 13.5 mm leaves x = 15, 16 and 17, and at the corners x = 14 and 15.
    let short = parted(&block(), vec![cut(13.5)], rule());
    let [bridge] = &short.bridges[..] else { panic!("{:?}", short.bridges) };
    let beyond = |x: f64, y: f64| (x - 2.0).hypot(y - 6.5) > 13.5;
    let columns = (2..=17).flat_map(|x| (2..=11).map(move |y| (f64::from(x), f64::from(y))));
    let left = columns.filter(|&(x, y)| beyond(x, y)).count();
    assert_eq!((bridge.segment, bridge.cut, bridge.faces), (0, 0, left));
    assert_eq!(bridge.area_mm2, left as f64);
    assert!(bridge.centre.x > 15.0 && bridge.centre.z == 15.0, "{:?}", bridge.centre);
    assert_eq!(short.segments[0].voxels, 16 * 10 * 14);
}

#[test]
fn seeds_that_mean_no_bone_are_refused_by_name() {
    let cut = || vec![Cut::unbounded("cut", plane([0.0, 0.0, 15.0], [0.0, 0.0, 1.0]))];
    let refused =
        |seed| labelled(&block(), cut(), vec![segment("part", &[(0, Side::Below)], &[seed])]);
    let (segment_name, cut_name) = ("part".to_owned(), "cut".to_owned());
    let across = LabelError::SeedAcross { segment: segment_name.clone(), seed: 0, cut: cut_name };
    assert_eq!(refused([9.0, 6.0, 20.0]).unwrap_err(), across);
    let off = refused([40.0, 6.0, 10.0]).unwrap_err();
    assert!(matches!(off, LabelError::SeedOffBone { seed: 0, .. }), "{off:?}");
    let told = off.to_string();
    // Where it is, where bone is, and that it may be in another frame.
    for part in ["(40, 6, 10)", "(2, 2, 4)", "frame"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    let nowhere = Cut::unbounded("cut", plane([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]));
    let none = labelled(&block(), vec![nowhere], vec![segment("part", &[(0, Side::Below)], &[])]);
    assert_eq!(none.unwrap_err(), LabelError::NoBone { segment: segment_name });
    let twice = vec![segment("one", &[], &[[4.0; 3]]), segment("other", &[], &[[4.0; 3]])];
    let meet = labelled(&block(), vec![], twice).unwrap_err();
    assert_eq!(meet, LabelError::SeedsMeet { one: "one".to_owned(), other: "other".to_owned() });
}

#[test]
fn bone_that_a_segment_does_not_reach_is_reported() {
    // An island of eight voxels beside the block.
    let island = scan([20, 14, 20], |x| {
        let block = (2.0..=11.0).contains(&x.x) && (2.0..=11.0).contains(&x.y);
        let island = (14.0..=15.0).contains(&x.x) && (5.0..=6.0).contains(&x.y);
        let height = if island { 10.0..=12.0 } else { 4.0..=30.0 };
        if (block || island) && height.contains(&x.z) { 1000.0 } else { 0.0 }
    });
    let found = parted(&island, vec![], vec![segment("part", &[], &[])]);
    let left = &found.segments[0].left;
    assert_eq!((left.pieces, left.voxels, left.largest_voxels), (1, 8, 8));
    assert_eq!(left.largest_centre, Vector::new(14.5, 5.5, 11.0));
    // Eight voxels are too few to hold tissue; the block is a segment.
    assert_eq!((found.loose.pieces, found.loose.voxels), (1, 8));
    let place = found.labels.nearest(&left.largest_centre, &Vector::x(), 2.0).unwrap();
    assert_eq!(place.owner, Owner::Loose);
}

#[test]
fn the_nearest_bone_lies_ahead_and_within_reach() {
    let cut = Cut::unbounded("cut", plane([0.0, 0.0, 15.0], [0.0, 0.0, 1.0]));
    let found = parted(&block(), vec![cut], vec![segment("part", &[(0, Side::Below)], &[])]);
    let nearest = |place: [f64; 3], ahead: Vector, reach: f64| {
        let bone = found.labels.nearest(&Vector::from(place), &ahead, reach)?;
        Some((bone.owner, bone.distance))
    };
    let beside = [1.5, 6.0, 10.0];
    assert_eq!(nearest(beside, Vector::x(), 3.0), Some((Owner::Segment(0), 0.5)));
    assert_eq!(nearest(beside, -Vector::x(), 3.0), None);
    assert_eq!(nearest(beside, Vector::x(), 0.4), None);
    assert_eq!(nearest([1.5, 6.0, 20.0], Vector::x(), 3.0), Some((Owner::Rest, 0.5)));
    assert_eq!(nearest([-50.0, 6.0, 20.0], Vector::x(), 3.0), None);
}

#[test]
fn teeth_are_what_is_bright_in_a_segment_and_end_where_the_reach_does() {
    // Two bright voxels, one in either half; the lower half is a segment.
    let image = scan([20, 14, 20], |x| {
        let inside = (2.0..=17.0).contains(&x.x) && (2.0..=11.0).contains(&x.y);
        let tooth = x == Vector::new(5.0, 5.0, 8.0) || x == Vector::new(5.0, 5.0, 24.0);
        match inside && (4.0..=30.0).contains(&x.z) {
            true if tooth => 2500.0,
            true => 1000.0,
            false => 0.0,
        }
    });
    let cut = Cut::unbounded("cut", plane([0.0, 0.0, 15.0], [0.0, 0.0, 1.0]));
    let found = parted(&image, vec![cut], vec![segment("part", &[(0, Side::Below)], &[])]);
    let bone = BoneImage { image: &image, threshold: 200.0 };
    let teeth = Teeth::new(&bone, &found.labels, ENAMEL_HU, 4.0);
    assert_eq!(teeth.voxels(), 1);
    let near = |x: f64, z: f64| teeth.near(&Vector::new(x, 5.0, z));
    assert_eq!(
        [near(5.0, 8.0), near(1.1, 8.0), near(0.9, 8.0), near(5.0, 24.0)],
        [true, true, false, false]
    );
}

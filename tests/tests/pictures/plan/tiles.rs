//! Tiles of a target: the rectangles that cover them, and the tiles near a shape.

use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::geometry::seen::{mark_seen, seen_rect};
use app_pipeline::geometry::silhouette::{Landing, Projection};
use app_pipeline::geometry::tiles::Tiles;
use glam::{UVec2, Vec2, Vec3, Vec3Swizzles};

/// Not a multiple of a tile.
const SIZE_PX: UVec2 = UVec2::new(77, 50);
const TILE_PX: u32 = 8;

/// Projects (x, y) of anchor space to pixels; a point of negative z is behind it.
struct Straight;

impl Projection for Straight {
    fn land(&self, in_anchor: Vec3) -> Option<Landing> {
        (in_anchor.z >= 0.0).then_some(Landing {
            at_px: in_anchor.xy(),
            within_px: Vec2::ZERO,
            may_be_cut: false,
        })
    }
}

fn pixels() -> impl Iterator<Item = UVec2> {
    (0..SIZE_PX.y).flat_map(|y| (0..SIZE_PX.x).map(move |x| UVec2::new(x, y)))
}

/// Two triangles, one of them small, another one beyond the target's corner, and a corner that
/// belongs to none of them.
const CORNERS: [u32; 9] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
fn positions(unused_z: f32) -> Vec<Vec3> {
    let in_target = [
        [13.0, 9.0],
        [40.0, 21.0],
        [17.0, 30.0],
        [60.0, 40.0],
        [61.0, 41.0],
        [60.5, 42.0],
    ];
    let beyond = [[90.0, 70.0], [99.0, 70.0], [90.0, 79.0]];
    let used = in_target.into_iter().chain(beyond);
    let used = used.map(|[x, y]| Vec3::new(x, y, 0.0));
    used.chain([Vec3::new(5.0, 45.0, unused_z)]).collect()
}

fn marked(reach_px: f32, positions: &[Vec3]) -> Tiles {
    let mut tiles = Tiles::over(SIZE_PX, TILE_PX);
    mark_seen(&mut tiles, positions, &CORNERS, &Straight, reach_px);
    tiles
}

/// Whether a pixel is within a distance, along both axes, of a position in a triangle of the
/// target.
fn is_near(px: UVec2, reach_px: f32, positions: &[Vec3]) -> bool {
    let steps = || (0..=20_u8).map(|step| f32::from(step) / 20.0);
    CORNERS.as_chunks().0.iter().any(|corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| positions[corner as usize].xy());
        steps().any(|u| {
            steps().any(|v| {
                let at = a + u * (b - a) + (1.0 - u) * v * (c - a);
                let low = px.as_vec2() - at;
                let high = low + 1.0;
                low.cmplt(Vec2::splat(reach_px)).all() && high.cmpgt(Vec2::splat(-reach_px)).all()
            })
        })
    })
}

#[test]
fn all_that_is_near_a_shape_is_marked() {
    let positions = positions(-1.0);
    for reach_px in [0.0, 3.0, 6.0] {
        let tiles = marked(reach_px, &positions);
        let missed = pixels().filter(|px| is_near(*px, reach_px, &positions) && !tiles.is_marked_at(*px));
        assert_eq!(missed.count(), 0, "within {reach_px} px");
        let n_marked = pixels().filter(|px| tiles.is_marked_at(*px)).count();
        assert!(
            n_marked < pixels().count() * 3 / 4,
            "{n_marked} within {reach_px} px"
        );
    }
    // The neighbourhood is larger than the marked one.
    let tiles = marked(0.0, &positions);
    assert!(pixels().any(|px| is_near(px, 11.0, &positions) && !tiles.is_marked_at(px)));
}

#[test]
fn a_shape_that_has_no_bounds_is_near_everything() {
    let mut positions = positions(0.0);
    positions[4].z = -1.0;
    let tiles = marked(0.0, &positions);
    assert!(pixels().all(|px| tiles.is_marked_at(px)));
    assert!(tiles.rects(false).is_empty());
}

#[test]
fn rectangles_fill_each_pixel_once() {
    let tiles = marked(3.0, &positions(0.0));
    let mut n_filled = [vec![], vec![]];
    for (is_marked, n_filled) in [false, true].into_iter().zip(&mut n_filled) {
        let rects = tiles.rects(is_marked);
        let holds = |px: UVec2| {
            let holding = rects.iter().filter(|rect| {
                px.cmpge(rect.origin_px).all() && px.cmplt(rect.origin_px + rect.size_px).all()
            });
            holding.count()
        };
        *n_filled = pixels().map(holds).collect();
        let within = |rect: &PixelRect| (rect.origin_px + rect.size_px).cmple(SIZE_PX).all();
        assert!(rects.iter().all(within), "{rects:?}");
        // Fewer than runs of tiles, since they continue from row to row.
        let n_rows = SIZE_PX.y.div_ceil(TILE_PX) as usize;
        assert!(rects.len() < 2 * n_rows, "{} rectangles", rects.len());
    }
    for (index, px) in pixels().enumerate() {
        let expected = [!tiles.is_marked_at(px), tiles.is_marked_at(px)].map(usize::from);
        assert_eq!(
            n_filled.each_ref().map(|filled| filled[index]),
            expected,
            "at {px}"
        );
    }
    // A single rectangle for all, and none for none.
    let mut all = Tiles::over(SIZE_PX, TILE_PX);
    assert_eq!(all.rects(false).len(), 1);
    all.mark_all();
    assert_eq!((all.rects(true).len(), all.rects(false).len()), (1, 0));
}

#[test]
fn tiles_are_joined_and_taken_away() {
    let mark = |low: [f32; 2], high: [f32; 2]| {
        let mut tiles = Tiles::over(SIZE_PX, TILE_PX);
        tiles.mark_box([Vec2::from(low), Vec2::from(high)]);
        tiles
    };
    let (first, second) = (mark([3.0, 3.0], [30.0, 20.0]), mark([20.0, 10.0], [60.0, 45.0]));
    let mut joined = first.clone();
    joined.join(&second);
    let rest = first.without(&second);
    let mut n_shared = 0;
    for px in pixels() {
        let marks = (first.is_marked_at(px), second.is_marked_at(px));
        n_shared += usize::from(marks == (true, true));
        assert_eq!(joined.is_marked_at(px), marks.0 || marks.1, "at {px}");
        assert_eq!(rest.is_marked_at(px), marks.0 && !marks.1, "at {px}");
    }
    assert!(n_shared > 0);
}

fn rect(origin_px: [u32; 2], size_px: [u32; 2]) -> PixelRect {
    PixelRect {
        origin_px: origin_px.into(),
        size_px: size_px.into(),
    }
}

#[test]
fn a_shape_is_seen_in_a_rectangle_of_the_target() {
    let seen = |corners: &[[f32; 3]]| {
        let positions: Vec<Vec3> = corners.iter().copied().map(Vec3::from).collect();
        seen_rect(&positions, &Straight, SIZE_PX)
    };
    // With a margin of one pixel, which a partly covered pixel is not.
    assert_eq!(
        seen(&[[13.2, 9.0, 0.0], [40.0, 21.5, 0.0]]),
        Some(rect([12, 8], [29, 15]))
    );
    assert_eq!(
        seen(&[[-9.0, 20.0, 0.0], [5.0, 90.0, 0.0]]),
        Some(rect([0, 19], [6, 31]))
    );
    assert_eq!(
        seen(&[[70.0, -4.0, 0.0], [99.0, 3.0, 0.0]]),
        Some(rect([69, 0], [8, 4]))
    );
    for beyond in [[-20.0, 20.0], [95.0, 20.0], [20.0, -20.0], [20.0, 70.0]] {
        assert_eq!(seen(&[[beyond[0], beyond[1], 0.0]]), None, "{beyond:?}");
    }
    // A point behind has no bounds, and neither has its shape.
    assert_eq!(
        seen(&[[13.0, 9.0, 0.0], [13.0, 9.0, -1.0]]),
        Some(rect([0, 0], [77, 50]))
    );
    assert_eq!(seen(&[]), None);
}

#[test]
fn what_is_beside_a_part_is_the_rest_once() {
    let whole = rect([3, 2], [20, 10]);
    for part in [
        rect([7, 5], [4, 3]),
        rect([3, 2], [5, 4]),
        rect([18, 8], [5, 4]),
        rect([3, 5], [20, 2]),
        whole,
    ] {
        let mut rects: Vec<PixelRect> = whole.beside(&part).collect();
        rects.push(part);
        for px in pixels() {
            let px = PixelRect {
                origin_px: px,
                size_px: UVec2::ONE,
            };
            let n_holding = rects.iter().filter(|rect| rect.contains(&px)).count();
            assert_eq!(n_holding, usize::from(whole.contains(&px)), "{part:?}: {px:?}");
        }
    }
}

//! Origins of the receivers' plane spaces.

use app_core::scene::{Receiver, Surface};
use app_pipeline::geometry::anchored::AnchoredReceiver;
use glam::{DMat4, DQuat, DVec2, DVec3};

/// Half a table's size.
const HALF_M: f64 = 2.0;
/// Position of the toy on it.
const TOY_IN_WORLD: DVec3 = DVec3::new(0.31, 0.12, -0.47);

/// A tilted table whose own plane space begins `aside_m` along x before its centre; it ends at the
/// same place along +x.
fn table(aside_m: f64) -> Receiver {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, -0.3);
    let aside = DMat4::from_translation(DVec3::new(-aside_m, 0.0, 0.0));
    Receiver {
        name: "table".to_owned(),
        world_from_plane: DMat4::from_quat(turn) * aside,
        half_extent_m: DVec2::new(HALF_M + aside_m, HALF_M),
        surface: Surface::Uniform,
    }
}

fn offset_m(a: &DMat4, b: &DMat4) -> f64 {
    (a.w_axis - b.w_axis).length()
}

#[test]
fn where_a_receivers_own_plane_begins_changes_nothing() {
    let near = AnchoredReceiver::near(&table(0.0), TOY_IN_WORLD);
    for aside_m in [1.0, 10.0, 100.0, 1000.0] {
        let far = AnchoredReceiver::near(&table(aside_m), TOY_IN_WORLD);
        // A kilometre in 53 bits is exact to 1e-13 m.
        assert!(
            offset_m(&near.world_from_plane, &far.world_from_plane) < 1e-11,
            "{aside_m} m"
        );
        assert!(
            (near.rect.max - far.rect.max).abs().max_element() < 1e-11,
            "{aside_m} m"
        );
    }
}

#[test]
fn a_plane_space_begins_near_the_toy_and_stays_when_that_moves_a_little() {
    let table = table(0.0);
    let near = AnchoredReceiver::near(&table, TOY_IN_WORLD);
    let toy = near.world_from_plane.inverse().transform_point3(TOY_IN_WORLD);
    assert!(toy.x.abs().max(toy.z.abs()) < 0.04, "{toy}");
    assert_eq!(
        near,
        AnchoredReceiver::near(&table, TOY_IN_WORLD + 0.001),
        "moved by a millimetre"
    );
    let far = AnchoredReceiver::near(&table, TOY_IN_WORLD + 1.0);
    assert!(
        offset_m(&near.world_from_plane, &far.world_from_plane) > 0.5,
        "moved by a metre"
    );
}

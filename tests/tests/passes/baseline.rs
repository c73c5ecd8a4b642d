//! The published method's `eligible`, `census`, `search`, `box_filter` and `pcss`, on textured and uniform receivers, under
//! one light and two.

use std::sync::LazyLock;

use app_core::core::CoreError;
use app_core::preset::{BASELINE, Preset};
use app_core::scene::Surface;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::readback::Map;
use glam::{DVec3, DVec4, UVec2};
use reference::box_filter::{box_sums, mean};
use reference::census::seen_sets;
use reference::model::Region;
use reference::pcss::{Softness, soft_visibility};
use reference::raster::{Raster, texels_of};
use reference::search::{Found, Rings, Start, search, term};
use reference::sets::LightSet;

use crate::cores::core_on;
use crate::device::Device;
use crate::errors::{Errors, channels};
use crate::photo::photograph;
use crate::run::{crop, input, raster, scene};
use crate::setups::{Beside, SETUPS, Setup};
use crate::stand::Stand;

/// The device's results for a setup by the published method.
struct BaselineRun {
    stand: Stand,
    is_textured: bool,
    region: Region,
    frame: Raster<DVec3>,
    plate: Raster<DVec3>,
    eligible: Raster<LightSet>,
    /// One raster per light.
    warp: Vec<Raster<DVec4>>,
    terms: Raster<DVec4>,
    taps: Raster<DVec4>,
    /// One raster per set of lights, from set 1 on.
    filtered: Vec<Raster<DVec4>>,
    visibility: Raster<DVec4>,
}

static RUNS: LazyLock<Result<Vec<BaselineRun>, String>> = LazyLock::new(|| {
    let decoded = Device::shared().decoded();
    let run = |(index, setup): (usize, Setup)| {
        // The eligible part excludes some pixels along every edge, so the shadow must be larger
        // than those.
        let stand = Stand::new(setup.twice());
        // Every other receiver is stated to be uniform.
        let run = BaselineRun::new(stand, index % 2 == 0, &decoded);
        run.map_err(|error| error.to_string())
    };
    // The published method has one receiver.
    let setups = SETUPS.into_iter().filter(|setup| setup.beside == Beside::Nothing);
    setups.enumerate().map(run).collect()
});

fn runs() -> &'static [BaselineRun] {
    match &*RUNS {
        Ok(runs) => runs,
        Err(error) => panic!("{error}"),
    }
}

impl BaselineRun {
    fn new(stand: Stand, is_textured: bool, decoded: &[f64]) -> Result<Self, CoreError> {
        let [plate, frame] = photograph(&stand);
        let mut scene = scene(&stand, &plate);
        scene.receivers[0].surface = if is_textured {
            Surface::Textured
        } else {
            Surface::Uniform
        };
        let mut core = core_on(scene, Preset::Paper)?;
        let report = core.frame(&input(&stand, &frame))?;
        let rect = report.region.expect("the toy moves");
        let map = |map| Ok::<_, CoreError>(raster(&core.read_map(map)?.expect("the method makes it")));
        Ok(Self {
            region: stand.region(&rect),
            frame: crop(&frame, &rect, decoded),
            plate: map(Map::Plate)?.map(DVec4::truncate),
            eligible: map(Map::Eligible)?.map(|texel| light_set(texel.x)),
            warp: layers(&map(Map::Warp)?, rect.size_px),
            terms: map(Map::Terms)?,
            taps: map(Map::SearchTaps)?,
            filtered: layers(&map(Map::FilteredTerms)?, rect.size_px),
            visibility: map(Map::Visibility)?,
            stand,
            is_textured,
        })
    }

    fn check(&self, pass: &str, errors: &Errors, allowed: (f64, f64), max: f64) {
        errors.check(&format!("{}, {pass}", self.stand.setup.name), allowed, max);
    }

    /// Texels of the shown shadows, with the lights that cast them and the original positions of
    /// those shadows.
    fn shaded(&self) -> impl Iterator<Item = (UVec2, Start)> + '_ {
        let size = self.region.size_px;
        let texels = texels_of(size);
        texels.filter_map(|texel| {
            let warps = (0..).zip(&self.warp).map(|(light, warp)| (light, warp.at(texel)));
            let (lights, sources_px): (Vec<u32>, Vec<_>) = warps
                .filter(|(_, warped)| warped.w > 0.0)
                .map(|(light, warped)| (light, warped.truncate().truncate()))
                .unzip();
            let set = LightSet::of(&lights);
            (!lights.is_empty()).then_some((texel, Start { set, sources_px }))
        })
    }
}

/// The layers that follow one another in a map, from top to bottom.
fn layers(map: &Raster<DVec4>, size: UVec2) -> Vec<Raster<DVec4>> {
    let layer = |index| Raster::from_fn(size, |texel| map.at(texel + UVec2::new(0, index * size.y)));
    (0..map.size().y / size.y).map(layer).collect()
}

fn light_set(number: f64) -> LightSet {
    LightSet(
        (0..4)
            .filter(|set| f64::from(*set) <= number)
            .max()
            .unwrap_or_default(),
    )
}

#[test]
fn ring_search() {
    let rings = Rings {
        step_px: f64::from(BASELINE.ring_step_px),
        n_directions: BASELINE.n_ring_directions,
        n_rings: BASELINE.n_rings,
    };
    for run in runs() {
        let seen = seen_sets(&run.eligible);
        let found: Vec<_> = run
            .shaded()
            .map(|(texel, start)| (texel, search(&run.eligible, &seen, &start, &rings), start.set))
            .collect();
        let taps = found
            .iter()
            .map(|(texel, found, _)| (run.taps.at(*texel).x, f64::from(found.n_taps)));
        // A candidate within rounding of a texel's border may fall to either side; halves represent
        // odd numbers up to 2048.
        run.check("taps", &Errors::between(taps), (1.0, 0.005), f64::INFINITY);
        let terms = found.iter().flat_map(|(texel, found, set)| {
            let expected = found.texel.map_or(DVec4::ZERO, |sample| {
                let sample = sample.as_uvec2();
                let term = term(run.frame.at(sample), run.plate.at(sample), run.is_textured);
                term.extend(f64::from(set.0))
            });
            let actual = run.terms.at(*texel);
            (0..4).map(move |channel| (actual[channel], expected[channel]))
        });
        // Halves have 11 bits: the error of values up to 2 is half of 2^-10.
        run.check("terms", &Errors::between(terms), (1e-3, 0.005), f64::INFINITY);
        let n_own = found.iter().filter(|(_, found, _)| found.n_taps == 0).count();
        let is_searched = |found: &Found| found.n_taps > 0 && found.texel.is_some();
        let n_searched = found.iter().filter(|(_, found, _)| is_searched(found)).count();
        let name = run.stand.setup.name;
        assert!(
            n_own > 0 && n_searched > 0,
            "{name}: {n_own} warped, {n_searched} searched"
        );
    }
}

#[test]
fn box_filter() {
    let radius_px = u32::try_from(BASELINE.box_radius_px).unwrap();
    for run in runs() {
        for (set, filtered) in (1..).map(LightSet).zip(&run.filtered) {
            let is_of_set = |term: &DVec4| light_set(term.w) == set;
            let terms = run.terms.map(|term| is_of_set(&term).then(|| term.truncate()));
            let expected = box_sums(&terms, radius_px);
            let sums = || filtered.texels().iter().zip(expected.texels());
            let counts = sums().map(|(actual, expected)| (actual.w, expected.w));
            run.check("count", &Errors::between(counts), (0.0, 0.0), 0.0);
            let means = sums()
                .filter_map(|(actual, expected)| mean(*actual).zip(mean(*expected)))
                .flat_map(|(actual, expected)| channels(actual, expected));
            // Two sums in halves, each with an error of half of 2^-10 for values up to 2.
            run.check("mean", &Errors::between(means), (2e-3, 0.0), 2e-3);
        }
    }
}

#[test]
fn percentage_closer_soft_shadows() {
    for run in runs() {
        for (light, warp) in run.warp.iter().enumerate() {
            run.check_visibility(light, warp);
        }
    }
}

impl BaselineRun {
    fn check_visibility(&self, index: usize, warp: &Raster<DVec4>) {
        let stand = &self.stand;
        let light = &stand.setup.lights[index];
        let softness = Softness {
            light: light.centre_in(&stand.anchor_from_world),
            light_radius: light.radius(),
            tallest_m: stand.tallest_m(),
            n_blocker_taps: BASELINE.n_blocker_taps,
            n_filter_taps: BASELINE.n_filter_taps,
        };
        let heights_m = warp.map(|texel| (texel.w > 0.0).then_some(texel.z));
        let expected = Raster::from_fn(self.region.size_px, |texel| {
            soft_visibility(&heights_m, &self.region, &[softness], texel)
        });
        let values = expected.texels();
        assert!(
            values.iter().any(|value| *value == 0.0 || *value < 0.25),
            "no shadow"
        );
        assert!(values.contains(&1.0), "no light");
        let actual = self.visibility.texels().iter().map(|texel| texel[index]);
        let errors = Errors::between(actual.zip(values.iter().copied()));
        // A tap within rounding of a texel's border may fall to either side, and a blocker more or
        // less changes the radius, which again moves a few taps to the other side.
        let tap = 1.0 / f64::from(BASELINE.n_filter_taps);
        self.check("pcss", &errors, (0.5 * tap, 0.01), 8.0 * tap);
    }
}

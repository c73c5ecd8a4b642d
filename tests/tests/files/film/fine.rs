//! Pictures of 16 bits, and layers, as other readers see them.

use std::fs;

use app_core::core::{FloatMap, Layers};
use app_scene::geometry::color::linear_from_srgb;
use exr::prelude::{ReadChannels, ReadLayers, read};
use film::animate::fine::{code_16, write_exr, write_png_16};
use harness::temporary::Temporary;
use image::DynamicImage;

const SIZE: [u32; 2] = [7, 5];

/// Different values for each seed, texel and channel.
fn map(seed: f32) -> FloatMap {
    let n = SIZE[0] * SIZE[1];
    let texel =
        |index: u32| [0.0, 0.25, 0.5, 0.75].map(|channel| (seed + channel) / 8.0 + index as f32 / 400.0);
    FloatMap {
        width: SIZE[0],
        height: SIZE[1],
        texels: (0..n).map(texel).collect(),
    }
}

#[test]
fn sixteen_bits_hold_every_code_of_eight_and_what_lies_between() {
    for code in 0..=u8::MAX {
        let linear = linear_from_srgb(f32::from(code) / 255.0);
        assert_eq!(code_16(linear), 257 * u16::from(code));
    }
    assert_eq!([code_16(-1.0), code_16(f32::MAX)], [0, u16::MAX]);
    let folder = Temporary::new("film-16");
    let path = folder.0.join("fine.png");
    let light = map(0.0);
    write_png_16(&path, &light).unwrap();
    let DynamicImage::ImageRgb16(read) = image::load_from_memory(&fs::read(&path).unwrap()).unwrap() else {
        panic!("not of 16 bits");
    };
    assert_eq!([read.width(), read.height()], SIZE);
    for (pixel, [r, g, b, _]) in read.pixels().zip(&light.texels) {
        assert_eq!(pixel.0, [*r, *g, *b].map(code_16));
    }
}

#[test]
fn an_exr_has_the_picture_and_its_layers_by_name() {
    let folder = Temporary::new("film-exr");
    let path = folder.0.join("layers.exr");
    let light = map(0.0);
    let layers = Layers {
        clean_plate: map(1.0),
        shadow_ratio: map(2.0),
        toy: map(3.0),
        masks: map(4.0),
    };
    write_exr(&path, &light, &layers).unwrap();
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(&path)
        .unwrap();
    let size = image.layer_data.size;
    assert_eq!([size.0, size.1], SIZE.map(|side| side as usize));
    let channels = &image.layer_data.channel_data.list;
    let expected = [
        ("", &["R", "G", "B"][..], &light),
        ("clean_plate.", &["R", "G", "B"], &layers.clean_plate),
        ("shadow_ratio.", &["R", "G", "B"], &layers.shadow_ratio),
        ("toy.", &["R", "G", "B", "A"], &layers.toy),
        ("masks.", &["R", "G", "B"], &layers.masks),
    ];
    let mut n_channels = 0;
    for (layer, names, map) in expected {
        for (index, name) in names.iter().enumerate() {
            let name = format!("{layer}{name}");
            let found = channels.iter().find(|channel| channel.name.to_string() == name);
            let values: Vec<f32> = found.unwrap().sample_data.values_as_f32().collect();
            assert_eq!(values.len(), map.texels.len());
            for (value, texel) in values.iter().zip(&map.texels) {
                // Half floats have 11 bits.
                assert!(
                    (value / texel[index] - 1.0).abs() < 1.0 / 2048.0 || texel[index] == *value,
                    "{name}"
                );
            }
            n_channels += 1;
        }
    }
    assert_eq!(channels.len(), n_channels);
}

//! A shot of key poses beside a session: photographs of further prints become its keys, and
//! `inbetween` makes the frames between.

use std::path::Path;

use app_core::session::record::{CaptureRecord, PoseRecord};
use desk::output::{write_png, write_whole};
use serde_json::{Value, json};

use super::{Given, Wanted};
use crate::inbetween::shot::{FORMAT, SHOT_FILE, VERSION};
use crate::photograph::Photograph;

/// A photograph of another print.
#[derive(Clone, Debug)]
pub struct Key {
    /// The file.
    pub path: std::path::PathBuf,
    /// The clip and the moment in seconds of the print's pose.
    pub moment: (String, f64),
}

fn key_file(index: usize) -> String {
    format!("key_{index}.png")
}

/// Writes the pictures of the keys and `shot.json` into a session's folder. The shot has the
/// session's record except for frames and pose.
pub(super) fn write(given: &Given, record: CaptureRecord, wanted: &Wanted, out: &Path) -> anyhow::Result<()> {
    let key = |index: usize, image: &str, pose: &PoseRecord| {
        json!({
            "image": image,
            "time": index as f64 * wanted.apart_secs,
            "physical_pose": pose,
        })
    };
    let mut keys = vec![key(0, &record.frames[0].image, &record.toy.physical_pose)];
    for (index, (photograph, of_print)) in (1..).zip(given.keys.iter().zip(&wanted.keys)) {
        let Photograph { image, .. } = photograph;
        write_png(&out.join(key_file(index)), image)?;
        let (clip, time) = of_print.moment.clone();
        let pose = PoseRecord {
            clip: Some(clip),
            time,
        };
        keys.push(key(index, &key_file(index), &pose));
    }
    let camera = json!(record.frames[0].world_from_camera);
    for key in &mut keys {
        key["world_from_camera"] = camera.clone();
    }
    let mut shot = serde_json::to_value(&record)?;
    shot["format"] = json!(FORMAT);
    shot["version"] = json!(VERSION);
    shot["keys"] = Value::from(keys);
    if let Value::Object(fields) = &mut shot {
        fields.remove("frames");
    }
    if let Some(toy) = shot["toy"].as_object_mut() {
        toy.remove("physical_pose");
    }
    write_whole(&out.join(SHOT_FILE), format!("{shot:#}\n").as_bytes())?;
    Ok(())
}

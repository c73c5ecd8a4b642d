//! The order of colours in a pixel.

/// Pixels of red, green, blue and alpha in the order of Apple's buffers: blue, green, red, alpha.
pub fn to_bgra(rgba: &[u8], bgra: &mut [u8]) {
    for (to, from) in bgra.chunks_exact_mut(4).zip(rgba.chunks_exact(4)) {
        to.copy_from_slice(&[from[2], from[1], from[0], from[3]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn red_and_blue_change_places() {
        let mut bgra = [0; 8];
        to_bgra(&[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12], &mut bgra);
        assert_eq!(bgra, [3, 2, 1, 4, 7, 6, 5, 8]);
    }
}

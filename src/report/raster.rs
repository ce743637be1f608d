//! Figures as PNG, drawn by the same SVG library that sets them in documents.

use crate::fonts;
use pipeline_base::error::{Error, Result};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};
use std::sync::{Arc, LazyLock};

/// Points of an SVG file in an inch.
const CSS_DPI: f64 = 96.0;
const MM_PER_INCH: f64 = 25.4;

static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut database = fontdb::Database::new();
    for font in fonts::ALL {
        database.load_font_data(font.to_vec());
    }
    Arc::new(database)
});

fn parse(svg: &str) -> Result<Tree> {
    let options = Options {
        fontdb: FONTS.clone(),
        ..Options::default()
    };
    Tree::from_str(svg, &options)
        .map_err(|e| Error::internal(format!("a figure is not an SVG: {e}")))
}

/// A figure as PNG on white paper, at so many dots per inch of its printed size, which the file states.
///
/// # Errors
/// If it is no SVG, or too large to be drawn.
pub fn svg_to_png(svg: &str, dpi: f64) -> Result<Vec<u8>> {
    let tree = parse(svg)?;
    let scale = (dpi / CSS_DPI) as f32;
    let pixels = |length: f32| (length * scale).round() as u32;
    let size = tree.size();
    let mut image = Pixmap::new(pixels(size.width()), pixels(size.height())).ok_or_else(|| {
        Error::internal(format!("a figure of {size:?} cannot be drawn at {dpi} dpi"))
    })?;
    image.fill(Color::WHITE);
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut image.as_mut(),
    );
    encode(&image, dpi)
}

/// An opaque image as PNG with its printed resolution. Quick compression: these files are for looking, the vector ones for print.
fn encode(image: &Pixmap, dpi: f64) -> Result<Vec<u8>> {
    let per_metre = (dpi / MM_PER_INCH * 1000.0).round() as u32;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width(), image.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: png::Unit::Meter,
    }));
    let opaque: Vec<u8> = image
        .data()
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect();
    let mut writer = encoder.write_header().map_err(Error::internal)?;
    writer.write_image_data(&opaque).map_err(Error::internal)?;
    writer.finish().map_err(Error::internal)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SVG: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="25.4mm" height="12.7mm" viewBox="0 0 20 10"><rect width="10" height="10"/></svg>"#;

    #[test]
    fn png_has_the_pixels_and_states_the_resolution() {
        let png = svg_to_png(SVG, 100.0).unwrap();
        let image = Pixmap::decode_png(&png).unwrap();
        assert_eq!((image.width(), image.height()), (100, 50));
        let dark = image.pixels().iter().filter(|p| p.red() < 10).count();
        assert_eq!(dark, 2500);
        assert_eq!(&png[37..41], b"pHYs");
        assert_eq!(png[41..45], 3937_u32.to_be_bytes());
    }
}

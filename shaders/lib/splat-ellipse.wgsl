// Bounds the visible part of a splat, an ellipse: which columns of a grid does it touch in a row?
// Reference: reference/splat-ellipse.ts. The bounds are conservative: they may include a cell that the ellipse only almost touches, and
// never leave out one that it touches, so that they cannot change the image.
import package::lib::splat_record::SplatAxes;
import package::lib::visible_ellipse::reachInAxes;

/// The visible part of a splat, about its centre.
struct SplatEllipse {
  centerPx: vec2f,
  /// Half width and half height of its box.
  extentPx: vec2f,
  /// Height above the centre of the rightmost point; the leftmost is opposite.
  rightmostPx: f32,
  /// The middle of a row moves sideways by this much per pixel of height.
  shear: f32,
  /// Half width of a row, per √(distance to the top · distance to the bottom).
  slimness: f32,
  /// Bounds are widened by this much: rounding errors grow with the ellipse.
  slackPx: f32,
}

/// Smallest widening: keeps pixels whose opacity is at the cutoff but for rounding.
const SLACK_PX = 0.01;
/// Widening per pixel of the ellipse's extent: sixteen float32 roundings.
const RELATIVE_SLACK = 1e-6;

fn splatEllipse(centerPx: vec2f, axes: SplatAxes, opacity: f32, alphaCutoff: f32) -> SplatEllipse {
  let reach = reachInAxes(opacity, alphaCutoff);
  // Sums of squares and products of perpendicular axes: nothing cancels, however thin the ellipse.
  let major = axes.majorUnit * axes.majorLengthPx;
  let minor = axes.minorUnit * axes.minorLengthPx;
  let half = sqrt(major * major + minor * minor);
  let skew = major.x * major.y + minor.x * minor.y;
  let area = abs(major.x * minor.y - major.y * minor.x);
  let extent = reach * half;
  return SplatEllipse(
    centerPx,
    extent,
    reach * skew / half.x,
    skew / half.y / half.y,
    area / half.y / half.y,
    SLACK_PX + RELATIVE_SLACK * (extent.x + extent.y + abs(centerPx.x) + abs(centerPx.y)),
  );
}

/// First and last column that contain a pixel centre of the ellipse's part between two rows of pixel
/// centres. Columns are `widthPx` wide from x = `left`. Clamped to −1…`columns`; first > last: none.
fn touchedColumns(ellipse: SplatEllipse, firstRowPx: f32, lastRowPx: f32, left: f32, widthPx: f32, columns: f32) -> vec2i {
  let low = max(firstRowPx - ellipse.slackPx - ellipse.centerPx.y, -ellipse.extentPx.y);
  let high = min(lastRowPx + ellipse.slackPx - ellipse.centerPx.y, ellipse.extentPx.y);
  if (!(low <= high)) { return vec2i(1, 0); }
  let atRight = clamp(ellipse.rightmostPx, low, high);
  let atLeft = clamp(-ellipse.rightmostPx, low, high);
  let x = ellipse.centerPx.x - left;
  let right = x + ellipse.shear * atRight + halfWidth(ellipse, atRight) + ellipse.slackPx;
  let leftmost = x + ellipse.shear * atLeft - halfWidth(ellipse, atLeft) - ellipse.slackPx;
  // Pixel centres lie at half-integers.
  return vec2i(
    i32(clamp(ceil((leftmost + 0.5) / widthPx) - 1.0, 0.0, columns)),
    i32(clamp(floor((right - 0.5) / widthPx), -1.0, columns - 1.0)),
  );
}

/// Half width of the ellipse at `y` px below its centre.
fn halfWidth(ellipse: SplatEllipse, y: f32) -> f32 {
  return ellipse.slimness * sqrt(max(0.0, (ellipse.extentPx.y - y) * (ellipse.extentPx.y + y)));
}

/// First and last row that contain a pixel centre of the ellipse's box. Rows are `heightPx` high from
/// y = `top`. Clamped to −1…`rows`; first > last: none.
fn touchedRows(ellipse: SplatEllipse, top: f32, heightPx: f32, rows: f32) -> vec2i {
  let reach = ellipse.extentPx.y + ellipse.slackPx;
  let y = ellipse.centerPx.y - top;
  return vec2i(
    i32(clamp(ceil((y - reach + 0.5) / heightPx) - 1.0, 0.0, rows)),
    i32(clamp(floor((y + reach - 0.5) / heightPx), -1.0, rows - 1.0)),
  );
}

// Divides the layer into bins and tiles, and lists the bins of a splat.
// Where the pairs of a frame would not fit, its bins are larger: 2^shift times as wide and as high,
// and as many times as wide and high are the blocks of tiles that the masks tell apart.
// Reference: `touchedBins` in stages/tiles/tiles.reference.ts.
import constants::BIN_PX;
import layout::TileGrid;
import package::lib::splat_ellipse::{SplatEllipse, touchedColumns, touchedRows};

/// First and last column of bins that the splat may touch in a row of bins.
fn binColumns(ellipse: SplatEllipse, row: i32, grid: TileGrid, shift: u32) -> vec2i {
  let binPx = BIN_PX * f32(1u << shift);
  let top = f32(row) * binPx;
  return touchedColumns(ellipse, top + 0.5, top + binPx - 0.5, 0.0, binPx, f32(columnCount(grid, shift)));
}

/// First and last row of bins that the splat's box touches.
fn binRows(ellipse: SplatEllipse, grid: TileGrid, shift: u32) -> vec2i {
  return touchedRows(ellipse, 0.0, BIN_PX * f32(1u << shift), f32(shifted(grid.binRows, shift)));
}

fn columnCount(grid: TileGrid, shift: u32) -> u32 {
  return shifted(grid.binColumns, shift);
}

/// Shift at which one bin covers the layer. Each visible splat is then a pair, without counting.
fn wholeShift(grid: TileGrid) -> u32 {
  return firstLeadingBit(max(grid.binColumns, grid.binRows) * 2u - 1u);
}

fn shifted(bins: u32, shift: u32) -> u32 {
  return (bins + (1u << shift) - 1u) >> shift;
}

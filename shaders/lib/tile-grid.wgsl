// Divides the layer into bins and tiles, and lists the bins of a splat. Used by the tile stages.
// Reference: reference/tile-grid.ts.
import constants::BIN_PX;
import layout::TileGrid;
import package::lib::splat_ellipse::{SplatEllipse, touchedColumns, touchedRows};

/// First and last column of bins that the splat may touch in a row of bins.
fn binColumns(ellipse: SplatEllipse, row: i32, grid: TileGrid) -> vec2i {
  let top = f32(row) * BIN_PX;
  return touchedColumns(ellipse, top + 0.5, top + BIN_PX - 0.5, 0.0, BIN_PX, f32(grid.binColumns));
}

/// First and last row of bins that the splat's box touches.
fn binRows(ellipse: SplatEllipse, grid: TileGrid) -> vec2i {
  return touchedRows(ellipse, 0.0, BIN_PX, f32(grid.binRows));
}

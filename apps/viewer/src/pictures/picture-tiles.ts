import { type Camera, cameraFromMatrices } from '@websplatter/core';

/** A part of a picture, and what is drawn for it. Lengths in pixels from the picture's top left corner. */
export interface PictureTile {
  readonly xPx: number;
  readonly yPx: number;
  readonly widthPx: number;
  readonly heightPx: number;
  /** Pixels that are drawn around it and left out, the same on all sides. */
  readonly marginPx: number;
}

/** Up to this size a picture is drawn at once: its layer and the copy that is read take some 200 MB. */
const MOST_PIXELS_AT_ONCE = 2 ** 23;
const TILE_PX = 2048;
/** More than upscaling from a lower resolution mixes, which at a tile's edge knows no neighbours. */
const MARGIN_PX = 32;

/** Divides a picture into rows of tiles, from the top; one tile where it can be drawn at once. */
export function pictureTiles(
  widthPx: number,
  heightPx: number,
  { mostPixels = MOST_PIXELS_AT_ONCE, longestSidePx = 8192, tilePx = TILE_PX, marginPx = MARGIN_PX } = {},
): readonly (readonly PictureTile[])[] {
  if (widthPx * heightPx <= mostPixels && Math.max(widthPx, heightPx) <= longestSidePx)
    return [[{ xPx: 0, yPx: 0, widthPx, heightPx, marginPx: 0 }]];
  const starts = (lengthPx: number) =>
    Array.from({ length: Math.ceil(lengthPx / tilePx) }, (_, i) => i * tilePx);
  return starts(heightPx).map((yPx) =>
    starts(widthPx).map((xPx) => ({
      xPx,
      yPx,
      widthPx: Math.min(tilePx, widthPx - xPx),
      heightPx: Math.min(tilePx, heightPx - yPx),
      marginPx,
    })),
  );
}

/** The camera whose image is `tile`, with its margin, of what `camera` shows in a picture of this size. */
export function tileCamera(camera: Camera, widthPx: number, heightPx: number, tile: PictureTile): Camera {
  const { marginPx } = tile;
  const [drawnWidthPx, drawnHeightPx] = drawnSize(tile);
  if (drawnWidthPx === widthPx && drawnHeightPx === heightPx) return camera;
  const leftPx = tile.xPx - marginPx;
  const topPx = tile.yPx - marginPx;
  // From the whole picture's clip space to the tile's: a scale, and a shift that counts w times.
  const scaleX = widthPx / drawnWidthPx;
  const scaleY = heightPx / drawnHeightPx;
  const shiftX = (widthPx - 2 * leftPx - drawnWidthPx) / drawnWidthPx;
  const shiftY = (drawnHeightPx - heightPx + 2 * topPx) / drawnHeightPx;
  const matrix = Float64Array.from(camera.projectionMatrix);
  for (let column = 0; column < 16; column += 4) {
    matrix[column] = scaleX * matrix[column] + shiftX * matrix[column + 3];
    matrix[column + 1] = scaleY * matrix[column + 1] + shiftY * matrix[column + 3];
  }
  const { viewMatrix, projectionMatrix, near, far } = camera;
  return {
    ...cameraFromMatrices(viewMatrix, matrix, { near, far }),
    wholeProjectionMatrix: projectionMatrix,
  };
}

/** Width and height of what is drawn for a tile. */
export function drawnSize({ widthPx, heightPx, marginPx }: PictureTile): readonly [number, number] {
  return [widthPx + 2 * marginPx, heightPx + 2 * marginPx];
}

import type { Camera } from '@websplatter/core';
import { reprojected } from '../camera/reprojected.ts';

/** A part of a picture, and the area drawn for it. Pixels from the picture's top left corner. */
export interface PictureTile {
  readonly xPx: number;
  readonly yPx: number;
  readonly widthPx: number;
  readonly heightPx: number;
  /** Pixels that are drawn around it and left out, the same on all sides. */
  readonly marginPx: number;
}

/** Largest picture drawn at once: its layer and the copy that is read take some 200 MB. */
const MOST_PIXELS_AT_ONCE = 2 ** 23;
const TILE_PX = 2048;
/** More than the reach of upscaling, which has no neighbours at a tile's edge. */
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

/** The camera whose image is `tile`, with its margin, of `camera`'s picture of this size. */
export function tileCamera(camera: Camera, widthPx: number, heightPx: number, tile: PictureTile): Camera {
  const { marginPx } = tile;
  const [drawnWidthPx, drawnHeightPx] = drawnSize(tile);
  if (drawnWidthPx === widthPx && drawnHeightPx === heightPx) return camera;
  const leftPx = tile.xPx - marginPx;
  const topPx = tile.yPx - marginPx;
  const shiftX = (widthPx - 2 * leftPx - drawnWidthPx) / drawnWidthPx;
  const shiftY = (drawnHeightPx - heightPx + 2 * topPx) / drawnHeightPx;
  return {
    ...reprojected(camera, [widthPx / drawnWidthPx, heightPx / drawnHeightPx], [shiftX, shiftY]),
    wholeProjectionMatrix: camera.projectionMatrix,
  };
}

/** Width and height of the area drawn for a tile. */
export function drawnSize({ widthPx, heightPx, marginPx }: PictureTile): readonly [number, number] {
  return [widthPx + 2 * marginPx, heightPx + 2 * marginPx];
}

import { type Camera, InvalidArgumentError, WebSplatterError } from '@websplatter/core';
import { reprojected } from '../camera/reprojected.ts';
import type { ShownFrame } from '../engine/viewer.ts';
import type { Vec3 } from '../state/vec3.ts';
import { FileWork, perViewer, sceneFileName } from './file-work.ts';
import { PngWriter, writePixels } from './png-writer.ts';

/** A part of a picture, and the area drawn for it. Pixels from the picture's top left corner. */
interface PictureTile {
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

/** PNG could be larger, but few programs could show it. */
export const MOST_SIDE_PX = 32_768;

export interface PictureOptions {
  readonly widthPx: number;
  readonly heightPx: number;
  readonly isTransparent: boolean;
}

/** Saves the frame on the screen as a picture of any size, one at a time. */
class Pictures extends FileWork {
  /** Draws the picture and hands it to the browser. Does nothing without a frame, or while busy. */
  async start(options: PictureOptions): Promise<void> {
    const shown = this.viewer.shownFrame;
    if (!shown || this.isBusy) return;
    const { store } = this;
    const fileName = sceneFileName(this.viewer, { extension: '.png' });
    const report = (part: number) => store.setState({ picturing: { fileName, part } });
    report(0);
    const { accuracy } = store.getState();
    await this.run({
      fileName,
      doing: 'Drawing',
      make: (signal) => drawPicture(shown, accuracy, options, report, signal),
      failureOf: (error) => ({
        title: `${fileName} cannot be drawn`,
        advice: 'A smaller picture takes less memory.',
        isFault: !(error instanceof WebSplatterError),
      }),
      onEnd: () => store.setState({ picturing: null }),
    });
  }
}

/** The viewer's one `Pictures`, made at the first call. */
export const picturesOf = perViewer((viewer, store) => new Pictures(viewer, store));

/** @throws InvalidArgumentError for an impossible size; errors of `render` and `readPixels`. */
export async function drawPicture(
  { engine, centred: frame }: ShownFrame,
  accuracy: ShownFrame['frame']['accuracy'],
  { widthPx, heightPx, isTransparent }: PictureOptions,
  onPart: (part: number) => void,
  signal: AbortSignal,
): Promise<Blob> {
  checkSize(widthPx, heightPx);
  const rows = pictureTiles(widthPx, heightPx, {
    longestSidePx: engine.device.limits.maxTextureDimension2D,
  });
  const count = rows.length * rows[0].length;
  const background = isTransparent ? null : (frame.background ?? [0, 0, 0]);
  const channels = background ? 3 : 4;
  const writer = new PngWriter(widthPx, heightPx, channels);
  // A view of its own: the screen's image stays, and the memory goes when the picture is there.
  const view = engine.createView();
  let drawn = 0;
  try {
    for (const tiles of rows) {
      const band = new Uint8Array(widthPx * tiles[0].heightPx * channels);
      for (const tile of tiles) {
        const [drawnWidthPx, drawnHeightPx] = drawnSize(tile);
        const camera = tileCamera(frame.camera, widthPx, heightPx, tile);
        view.render({ ...frame, accuracy, camera, widthPx: drawnWidthPx, heightPx: drawnHeightPx });
        const { data } = await view.readPixels();
        signal.throwIfAborted();
        copyTile(data, band, tile, widthPx, background);
        onPart(++drawn / count);
      }
      await writer.writeRows(band);
      signal.throwIfAborted();
    }
    return await writer.finish();
  } catch (error) {
    writer.abort();
    throw error;
  } finally {
    view.destroy();
  }
}

/** Copies a drawn tile without its margin into the rows of the picture that it is in. */
function copyTile(
  drawn: Float32Array,
  band: Uint8Array,
  tile: PictureTile,
  pictureWidthPx: number,
  background: Vec3 | null,
): void {
  const channels = background ? 3 : 4;
  const [drawnWidthPx] = drawnSize(tile);
  for (let row = 0; row < tile.heightPx; row++) {
    const from = 4 * ((row + tile.marginPx) * drawnWidthPx + tile.marginPx);
    const to = channels * (row * pictureWidthPx + tile.xPx);
    const pixels = drawn.subarray(from, from + 4 * tile.widthPx);
    writePixels(pixels, band.subarray(to, to + channels * tile.widthPx), background);
  }
}

function checkSize(widthPx: number, heightPx: number): void {
  for (const [name, sidePx] of Object.entries({ widthPx, heightPx })) {
    if (Number.isInteger(sidePx) && sidePx >= 1 && sidePx <= MOST_SIDE_PX) continue;
    throw new InvalidArgumentError(
      name,
      `${name} is ${sidePx}; a side of a picture has from 1 to ${MOST_SIDE_PX} whole pixels.`,
    );
  }
}

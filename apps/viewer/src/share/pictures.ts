import { InvalidArgumentError, WebSplatterError } from '@websplatter/core';
import type { ShownFrame } from '../engine/drawn-frame.ts';
import type { Vec3 } from '../state/vec3.ts';
import { FileWork, perViewer } from './file-work.ts';
import { drawnSize, type PictureTile, pictureTiles, tileCamera } from './picture-tiles.ts';
import { PngWriter, writePixels } from './png-writer.ts';
import { savedName } from './saved-name.ts';

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
    const fileName = savedName([store.getState().scene?.title ?? ''], { extension: '.png' });
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

/** Those of a viewer. */
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

import { toPostedError } from '../io/loading/load-messages.ts';
import { clusterHarmonics } from '../packing/cluster-harmonics.ts';
import type { PaletteReply, PaletteRequest } from './palette-messages.ts';

/** The part of a worker's global scope that is used; a MessagePort has it too. */
export interface PalettePort {
  onmessage: ((event: MessageEvent<PaletteRequest>) => void) | null;
  postMessage(reply: PaletteReply, transfer: Transferable[]): void;
}

/** Finds the palette that the page asks for, and posts progress and outcome. */
export function servePalette(port: PalettePort): void {
  port.onmessage = async ({ data: { harmonics, count, entryCount } }) => {
    const onProgress = (part: number) => port.postMessage({ kind: 'progress', part }, []);
    try {
      const palette = await clusterHarmonics(harmonics, count, { entryCount, onProgress });
      const buffers = [palette.entries.buffer, palette.indices.buffer] as ArrayBuffer[];
      port.postMessage({ kind: 'palette', palette }, buffers);
    } catch (error) {
      port.postMessage({ kind: 'error', error: toPostedError(error) }, []);
    }
  };
  port.postMessage({ kind: 'ready' }, []);
}

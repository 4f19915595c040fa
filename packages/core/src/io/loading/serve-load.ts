import { transferablesOf } from '../../packing/packed-cloud.ts';
import type { FormatReaders } from '../formats/splat-format.ts';
import { type LoadReply, type LoadRequest, toPostedError } from './load-messages.ts';
import { OtherFormat } from './other-format.ts';
import { PostedRows } from './posted-rows.ts';
import { readAndPack } from './read-and-pack.ts';

/** The part of a worker's global scope that is used; a MessagePort has it too. */
export interface LoadPort {
  onmessage: ((event: MessageEvent<LoadRequest>) => void) | null;
  postMessage(reply: LoadReply, transfer: Transferable[]): void;
}

/**
 * Does the loads that the page asks for, one after another, and posts their progress and outcome.
 *
 * @param readers files of other formats are given back.
 */
export function serveLoad(port: LoadPort, readers: FormatReaders): void {
  let sink = new PostedRows(port);
  port.onmessage = async ({ data: request }) => {
    if (request.kind === 'memory') {
      sink.giveBack(request.memory);
      return;
    }
    const { source, settings, rows } = request;
    sink = new PostedRows(port);
    try {
      const watch = {
        onProgress: (progress) => port.postMessage({ kind: 'progress', progress }, []),
      } satisfies Parameters<typeof readAndPack>[2];
      const cloud = await readAndPack(
        source,
        settings,
        watch,
        readers,
        rows ? { sink, files: rows } : undefined,
      );
      if (cloud === 'passed') port.postMessage({ kind: 'rows-end' }, []);
      else port.postMessage({ kind: 'cloud', cloud }, transferablesOf(cloud));
    } catch (error) {
      if (error instanceof OtherFormat) {
        const { stream } = error;
        port.postMessage({ kind: 'other-format', stream }, stream ? [stream] : []);
      } else port.postMessage({ kind: 'error', error: toPostedError(error) }, []);
    }
  };
  port.postMessage({ kind: 'ready' }, []);
}

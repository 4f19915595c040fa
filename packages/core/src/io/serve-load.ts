import { transferablesOf } from '../packing/packed-cloud.ts';
import { type LoadReply, type LoadRequest, toPostedError } from './load-messages.ts';
import { readAndPack } from './read-and-pack.ts';

/** The part of a worker's global scope that is used; a MessagePort has it too. */
export interface LoadPort {
  onmessage: ((event: MessageEvent<LoadRequest>) => void) | null;
  postMessage(reply: LoadReply, transfer: Transferable[]): void;
}

/** Does the one load that the page asks for and posts its progress and outcome. */
export function serveLoad(port: LoadPort): void {
  port.onmessage = async ({ data: { source, settings } }) => {
    try {
      const cloud = await readAndPack(source, settings, {
        onProgress: (progress) => port.postMessage({ kind: 'progress', progress }, []),
      });
      port.postMessage({ kind: 'cloud', cloud }, transferablesOf(cloud));
    } catch (error) {
      port.postMessage({ kind: 'error', error: toPostedError(error) }, []);
    }
  };
  port.postMessage({ kind: 'ready' }, []);
}

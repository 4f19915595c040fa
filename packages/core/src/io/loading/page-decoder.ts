import type { DecodeMeshopt } from '../containers/meshopt.ts';
import type { FormatReaders } from '../formats/read-format.ts';
import { fromPostedError } from '../posted-error.ts';
import type { UnpackedReply } from './load-messages.ts';
import type { LoadPort } from './serve-load.ts';

/**
 * Returns `readers` that send meshopt data over `port`, to be decoded on the main thread: the worker
 * cannot fetch the decoder.
 */
export function withPageDecoder(port: LoadPort, readers: FormatReaders): FormatReaders {
  const decodeMeshopt: DecodeMeshopt = (view) =>
    new Promise((resolve, reject) => {
      const { port1, port2 } = new MessageChannel();
      port1.onmessage = ({ data }: MessageEvent<UnpackedReply>) => {
        port1.close();
        if ('error' in data) reject(fromPostedError(data.error));
        else resolve(data.bytes);
      };
      port.postMessage({ kind: 'packed-view', view, reply: port2 }, [port2, view.bytes.buffer]);
    });
  return { ...readers, decodeMeshopt };
}

import { toPostedError } from '../io/loading/load-messages.ts';
import { ColliderBuilder } from './build-collider.ts';
import type { ColliderReply, ColliderRequest } from './collider-messages.ts';

/** The part of a worker's global scope that is used; a MessagePort has it too. */
export interface ColliderPort {
  onmessage: ((event: MessageEvent<ColliderRequest>) => void) | null;
  postMessage(reply: ColliderReply, transfer: Transferable[]): void;
}

/** Makes the collider that the page asks for. */
export function serveCollider(port: ColliderPort): void {
  let builder: ColliderBuilder;
  const answer = async (request: ColliderRequest) => {
    if (request.collider === 'plan') builder = new ColliderBuilder(request.plan);
    else if (request.collider === 'piece') await builder.add(request.piece);
    else {
      const mesh = await builder.finish();
      const buffers = [mesh.positions.buffer, mesh.indices.buffer] as ArrayBuffer[];
      port.postMessage({ kind: 'mesh', mesh }, buffers);
      return;
    }
    port.postMessage({ kind: 'taken' }, []);
  };
  port.onmessage = ({ data }) => {
    answer(data).catch((error) => port.postMessage({ kind: 'error', error: toPostedError(error) }, []));
  };
  port.postMessage({ kind: 'ready' }, []);
}

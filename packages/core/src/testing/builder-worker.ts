import { MessageChannel, type MessagePort } from 'node:worker_threads';
import {
  type BuildPort,
  type BuildRequest,
  type GeometryBuilders,
  serveBuilder,
} from '../clouds/geometry-builder.ts';

type Behaviour = 'works' | 'dies';

/** Class of workers in this thread: messages are cloned or transferred as between threads. */
export function builderWorker(builders: GeometryBuilders) {
  return class FakeWorker {
    static behaviour: Behaviour = 'works';
    static started: FakeWorker[] = [];
    onmessage: ((event: MessageEvent) => void) | null = null;
    onerror: ((event: Partial<ErrorEvent>) => void) | null = null;
    onmessageerror: (() => void) | null = null;
    isTerminated = false;
    readonly page: MessagePort;

    constructor() {
      FakeWorker.started.push(this);
      const { port1, port2 } = new MessageChannel();
      this.page = port1;
      port1.on('message', (data) => this.onmessage?.({ data } as MessageEvent));
      const port: BuildPort = {
        onmessage: null,
        postMessage: (reply, transfer) => port2.postMessage(reply, transfer as never),
      };
      port2.on('message', (data) => port.onmessage?.({ data } as MessageEvent<BuildRequest>));
      serveBuilder(port, builders);
    }

    postMessage(request: BuildRequest, transfer: Transferable[]): void {
      if (FakeWorker.behaviour === 'dies') setTimeout(() => this.onerror?.({ message: 'out of memory' }));
      else this.page.postMessage(request, transfer as never);
    }

    terminate(): void {
      this.isTerminated = true;
      this.page.close();
    }
  };
}

import { MessageChannel, type MessagePort } from 'node:worker_threads';
import { type RemoteRequest, type ServerPort, serve, type Tasks } from '../io/remote.ts';

type Behaviour = 'works' | 'dies' | 'is busy' | 'throws' | 'does not start';

/**
 * Class of workers in this thread: messages are cloned or transferred as between threads.
 *
 * @param tasksOf makes the tasks that the script of a worker serves.
 * @param besides see `serve`.
 */
export function fakeWorker(tasksOf: () => Tasks, besides: readonly string[] = []) {
  return class FakeWorker {
    static behaviour: Behaviour = 'works';
    static started: FakeWorker[] = [];
    static requests: RemoteRequest[] = [];
    onmessage: ((event: MessageEvent) => void) | null = null;
    onerror: ((event: Partial<ErrorEvent>) => void) | null = null;
    onmessageerror: (() => void) | null = null;
    isTerminated = false;
    readonly page: MessagePort;

    constructor() {
      if (FakeWorker.behaviour === 'throws') throw new DOMException('not allowed here', 'SecurityError');
      FakeWorker.started.push(this);
      const { port1, port2 } = new MessageChannel();
      this.page = port1;
      port1.on('message', (data) => this.onmessage?.({ data } as MessageEvent));
      if (FakeWorker.behaviour === 'does not start') {
        setTimeout(() => this.onerror?.({ preventDefault() {} }));
        return;
      }
      const port: ServerPort = {
        onmessage: null,
        postMessage: (reply, transfer) => port2.postMessage(reply, transfer as never),
      };
      port2.on('message', (data) => port.onmessage?.({ data } as MessageEvent));
      serve(tasksOf(), port, besides);
    }

    postMessage(request: RemoteRequest, transfer: Transferable[]): void {
      FakeWorker.requests.push(request);
      if (FakeWorker.behaviour === 'dies') setTimeout(() => this.onerror?.({ message: 'out of memory' }));
      else if (FakeWorker.behaviour !== 'is busy') this.page.postMessage(request, transfer as never);
    }

    terminate(): void {
      this.isTerminated = true;
      this.page.close();
    }
  };
}

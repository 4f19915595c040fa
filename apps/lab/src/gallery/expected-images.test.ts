import { describe, expect, it } from 'vitest';
import { ExpectedImages } from './case-comparison.tsx';

/** A worker that answers when it is told to. */
class TestWorker {
  onmessage: ((event: { data: unknown }) => void) | null = null;
  onerror: ((event: { message: string }) => void) | null = null;
  readonly asked: { readonly id: number }[] = [];
  isTerminated = false;

  postMessage(request: { readonly id: number }): void {
    this.asked.push(request);
  }

  terminate(): void {
    this.isTerminated = true;
  }
}

function setUp() {
  const workers: TestWorker[] = [];
  const images = new ExpectedImages(() => {
    const worker = new TestWorker();
    workers.push(worker);
    return worker as unknown as Worker;
  });
  /** Has a worker answer the last request. */
  const answer = async (index: number, result: unknown) => {
    await expect.poll(() => workers[index].asked).not.toHaveLength(0);
    const { id } = workers[index].asked.pop()!;
    workers[index].onmessage?.({ data: { kind: 'done', id, result } });
  };
  return { workers, images, answer };
}

const request = (name: string) => ({ name, cameraName: 'front', widthPx: 1, heightPx: 1 });

describe('the images that float64 defines', () => {
  it('come from one worker, and the last one is kept', async () => {
    const { workers, images, answer } = setUp();
    const first = images.ask(request('a'));
    await answer(0, [1]);
    expect(await first).toEqual([1]);
    expect(await images.ask(request('a'))).toEqual([1]);
    expect(workers[0].asked).toHaveLength(0);
    const second = images.ask(request('b'));
    await answer(0, [2]);
    expect(await second).toEqual([2]);
    expect(workers).toHaveLength(1);
  });

  it('give up what takes long when another is asked for', async () => {
    const { workers, images, answer } = setUp();
    const slow = images.ask(request('slow'));
    const other = images.ask(request('other'));
    await expect(slow).rejects.toThrow('aborted');
    expect(workers.map(({ isTerminated }) => isTerminated)).toEqual([true, false]);
    await answer(1, [3]);
    expect(await other).toEqual([3]);
  });

  it('reject where the worker fails, and can be asked for again', async () => {
    const { workers, images, answer } = setUp();
    const failing = images.ask(request('a'));
    await expect.poll(() => workers[0].onerror).toBeTruthy();
    workers[0].onerror?.({ message: 'It broke.' });
    await expect(failing).rejects.toThrow('It broke.');
    const again = images.ask(request('a'));
    await answer(1, [1]);
    expect(await again).toEqual([1]);
  });
});

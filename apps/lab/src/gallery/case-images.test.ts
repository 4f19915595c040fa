import { describe, expect, it } from 'vitest';
import { Turns } from './case-images.ts';

describe('work in turns', () => {
  it('is done one after the other, in order, each when the page is idle', async () => {
    const events: string[] = [];
    const turns = new Turns(async () => {
      events.push('idle');
    });
    const { signal } = new AbortController();
    const work = (name: string) =>
      turns.take(async () => {
        events.push(`${name} begins`);
        await Promise.resolve();
        events.push(`${name} ends`);
        return name;
      }, signal);
    expect(await Promise.all([work('a'), work('b')])).toEqual(['a', 'b']);
    expect(events).toEqual(['idle', 'a begins', 'a ends', 'idle', 'b begins', 'b ends']);
  });

  it('goes on after work that fails, and leaves out what was given up before its turn', async () => {
    const turns = new Turns(async () => {});
    const given = new AbortController();
    const { signal } = new AbortController();
    const failing = turns.take(() => Promise.reject(new Error('broken')), signal);
    let isDone = false;
    const givenUp = turns.take(async () => {
      isDone = true;
    }, given.signal);
    const last = turns.take(async () => 'last', signal);
    given.abort(new Error('given up'));
    await expect(failing).rejects.toThrow('broken');
    await expect(givenUp).rejects.toThrow('given up');
    expect(await last).toBe('last');
    expect(isDone).toBe(false);
  });
});

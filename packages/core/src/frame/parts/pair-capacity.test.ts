import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { DEFAULT_TILE_BUDGET_BYTES, PAIR_BYTES, PairRoom, pairCapacity } from './pair-capacity.ts';

const MOST = 22_000_000;

describe('pairCapacity', () => {
  test('guesses a pair per visible splat before any number is known, and more where that costs little', () => {
    const first = pairCapacity(0, null, 1_000_000, MOST);
    expect(first).toBeGreaterThan(1_000_000);
    expect(first).toBeLessThan(1_400_000);
    expect(pairCapacity(0, null, 10_000, MOST)).toBeGreaterThan(40_000);
    expect(pairCapacity(0, null, 100_000, MOST)).toBeGreaterThan(250_000);
    expect(pairCapacity(0, null, 100_000, MOST)).toBeLessThan(300_000);
  });

  test('has spare room for what a recent frame needed, and is kept while that suits', () => {
    const room = pairCapacity(0, 1_000_000, 5000, MOST);
    expect(room).toBeGreaterThan(1_100_000);
    expect(room).toBeLessThan(1_400_000);
    for (const needed of [1_200_000, 1_000_000, Math.ceil(0.4 * room)])
      expect(pairCapacity(room, needed, 5000, MOST)).toBe(room);
  });

  test('grows if a frame needed more, and shrinks if it needed much less', () => {
    expect(pairCapacity(100_000, 100_001, 5000, MOST)).toBeGreaterThan(100_001);
    // Before it is too late: the next frame may need a little more.
    expect(pairCapacity(100_000, 95_000, 5000, MOST)).toBeGreaterThan(100_000);
    expect(pairCapacity(1_000_000, 399_999, 5000, MOST)).toBeLessThan(600_000);
  });

  test('ends at what budget and device allow, even if a frame needs more', () => {
    expect(pairCapacity(0, 30_000_000, 5000, MOST)).toBe(MOST);
    expect(pairCapacity(MOST, 30_000_000, 5000, MOST)).toBe(MOST);
    // A smaller budget than before.
    expect(pairCapacity(MOST, 20_000_000, 5000, 1000)).toBe(1000);
  });

  test('is never nothing, since buffers cannot be empty', () => {
    for (const most of [0, 1, MOST]) {
      expect(pairCapacity(0, null, 0, most)).toBeGreaterThan(0);
      expect(pairCapacity(0, 0, 0, most)).toBeGreaterThan(0);
    }
  });

  test('settles: with the same needs, the next frame changes nothing', () => {
    const pairs = fc.integer({ min: 0, max: 2 ** 31 });
    const needs = fc.option(pairs);
    fc.assert(
      fc.property(
        pairs,
        needs,
        pairs,
        fc.integer({ min: 1, max: 2 ** 25 }),
        (current, needed, visible, most) => {
          const room = pairCapacity(current, needed, visible, most);
          expect(room).toBeGreaterThan(0);
          expect(room).toBeLessThanOrEqual(most);
          const wanted = needed ?? visible;
          if (wanted <= most) expect(room).toBeGreaterThanOrEqual(wanted);
          expect(pairCapacity(room, needed, visible, most)).toBe(room);
        },
      ),
    );
  });

  test('holds 8 bytes of keys and records, and a bit per tile of a bin, per pair', () => {
    expect(PAIR_BYTES).toBe(16);
    expect(Math.floor(DEFAULT_TILE_BUDGET_BYTES / PAIR_BYTES)).toBeGreaterThan(MOST);
  });
});

describe('PairRoom', () => {
  const SPLATS = 120_000;
  const FRAME_MS = 20;

  /** Room for pairs of a view, frame by frame. */
  class Frames {
    readonly #room = new PairRoom();
    #atMs = 0;
    /** Number of pairs that there is room for. */
    pairs = 0;

    /** The next frame: room is made for it, and it turns out to need `neededPairs`. */
    draw(neededPairs: number, visibleCapacity = SPLATS): number {
      const canStay = this.pairs > 0;
      const pairs = this.#room.next(this.pairs, visibleCapacity, MOST, canStay);
      if (!canStay || pairs !== this.pairs) this.#room.made(visibleCapacity);
      this.pairs = pairs;
      this.#atMs += FRAME_MS;
      this.#room.take(neededPairs, this.#atMs);
      return pairs;
    }
  }

  test('is less than was guessed, once frames have shown how many pairs there are', () => {
    const frames = new Frames();
    const guessed = frames.draw(150_000);
    // Not so few that room is given back in any case.
    expect(150_000).toBeGreaterThan(0.4 * guessed);
    const rooms = Array.from({ length: 40 }, () => frames.draw(150_000));
    expect(new Set(rooms.slice(0, 10))).toEqual(new Set([guessed]));
    expect(frames.pairs).toBeLessThan(0.85 * guessed);
    expect(frames.pairs).toBeGreaterThan(150_000);
    // It is judged once.
    expect(new Set(rooms.slice(12))).toEqual(new Set([frames.pairs]));
  });

  test('stays where it was guessed well', () => {
    const frames = new Frames();
    const guessed = frames.draw(220_000);
    expect(1.35 * 220_000).toBeGreaterThan(0.85 * guessed);
    for (let frame = 0; frame < 40; frame++) expect(frames.draw(220_000)).toBe(guessed);
  });

  test('grows for the next frame where one needed more', () => {
    const frames = new Frames();
    const guessed = frames.draw(3 * SPLATS);
    expect(guessed).toBeLessThan(3 * SPLATS);
    expect(frames.draw(3 * SPLATS)).toBeGreaterThan(3 * SPLATS);
  });

  test('grows along with the splats of a file that arrives', () => {
    const frames = new Frames();
    frames.draw(3 * SPLATS);
    frames.draw(3 * SPLATS);
    expect(frames.draw(6 * SPLATS, 2 * SPLATS)).toBeGreaterThan(6 * SPLATS);
  });

  test('is kept for pairs that were needed a moment ago, and given back seconds later', () => {
    const frames = new Frames();
    frames.draw(3 * SPLATS);
    const room = frames.draw(3 * SPLATS);
    const secondFrames = 1000 / FRAME_MS;
    for (let frame = 0; frame < 2 * secondFrames; frame++) expect(frames.draw(1000)).toBe(room);
    for (let frame = 0; frame < 12 * secondFrames; frame++) frames.draw(1000);
    expect(frames.pairs).toBeLessThan(0.2 * room);
  });
});

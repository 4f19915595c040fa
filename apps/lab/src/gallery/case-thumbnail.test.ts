import { describe, expect, it } from 'vitest';
import { ownPart, wordsForNothing } from './case-thumbnail.tsx';

const SIZE = { widthPx: 16, heightPx: 8 };
const ALL = { leftPx: 0, topPx: 0, ...SIZE };

/** A dark green picture, in which some pixels are red. */
function picture(isRed: (x: number, y: number) => boolean): number[] {
  return Array.from({ length: 16 * 8 }, (_, i) =>
    isRed(i % 16, Math.floor(i / 16)) ? [1, 0, 0, 1] : [0, 0.5, 0, 1],
  ).flat();
}

const ordinary = picture(() => false);

describe('what of a case’s picture is its own', () => {
  it('keeps its colours, magnified, while the rest is grey', () => {
    const { pixels, box } = ownPart(
      picture((x, y) => x === 8 && y === 4),
      ordinary,
      SIZE,
    );
    expect(pixels.slice(0, 4)).toEqual(Uint8ClampedArray.of(41, 41, 41, 255));
    const at = 4 * (4 * 16 + 8);
    expect(pixels.slice(at, at + 4)).toEqual(Uint8ClampedArray.of(255, 0, 0, 255));
    expect(box).toEqual({ leftPx: 8.5 - 1.6, topPx: 4.5 - 0.8, widthPx: 3.2, heightPx: 1.6 });
  });

  it('stays within the picture at its edges', () => {
    const { box } = ownPart(
      picture((x, y) => x === 0 && y === 7),
      ordinary,
      SIZE,
    );
    expect(box).toEqual({ leftPx: 0, topPx: 6.4, widthPx: 3.2, heightPx: 1.6 });
  });

  it('is bright enough to be seen', () => {
    const dark = picture(() => false).map((value, i) => (i % 4 === 3 ? value : 0.1 * value + 0.01));
    expect(Math.max(...ownPart(dark, ordinary, SIZE).pixels.filter((_, i) => i % 4 !== 3))).toBe(128);
  });

  it('is said in words where there is nothing to see', () => {
    expect(
      wordsForNothing(
        ordinary.map(() => 0),
        ordinary,
      ),
    ).toBe('nothing visible');
    expect(wordsForNothing(ordinary, ordinary)).toBe('adds nothing visible');
    expect(
      wordsForNothing(
        picture((x) => x === 3),
        ordinary,
      ),
    ).toBeNull();
  });

  it.each([
    ['nothing', () => false],
    ['all', () => true],
    ['one line from edge to edge', (_: number, y: number) => y === 3],
  ])('is the whole picture where %s differs', (_, isRed) => {
    expect(ownPart(picture(isRed), ordinary, SIZE).box).toEqual(ALL);
  });
});

import { describe, expect, it } from 'vitest';
import { builtinSource, firstSource } from './first-source.ts';

const BASE = 'http://localhost/viewer/?x=1';

describe('first source', () => {
  it('is the file of the address, relative to the page', () => {
    const { source, notice } = firstSource({ file: 'a.ply', scene: 'hard:far-origin' }, BASE, true);
    expect(source).toEqual({ kind: 'url', url: new URL('http://localhost/viewer/a.ply') });
    expect(notice).toBeNull();
  });

  it('is the named scene where the file has no address, and says so', () => {
    const { source, notice } = firstSource({ file: 'http://[', scene: 'hard:far-origin' }, BASE, true);
    expect(source).toEqual({ kind: 'hard-case', name: 'far-origin' });
    expect(notice).toBe('“http://[” is not an address.');
  });

  it.each([
    [true, 'still-life-small'],
    [false, 'still-life'],
  ])('is the default scene without an address (software adapter: %s)', (isSoftware, name) => {
    expect(firstSource({}, BASE, isSoftware)).toMatchObject({
      source: { kind: 'builtin', scene: { name } },
      notice: null,
    });
  });

  it('is the default scene where there is none of that name, and says so', () => {
    const { source, notice } = firstSource({ scene: 'nowhere' }, BASE, true);
    expect(source).toMatchObject({ scene: { name: 'still-life-small' } });
    expect(notice).toBe('There is no built-in scene “nowhere”.');
  });

  it('takes the default scene in place of a hard case that failed, without a notice', () => {
    expect(builtinSource('hard:far-origin', false)).toMatchObject({
      source: { scene: { name: 'still-life' } },
      notice: null,
    });
  });
});

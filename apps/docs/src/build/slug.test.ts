import { describe, expect, it } from 'vitest';
import { slug } from './slug.ts';

describe('the anchor of a heading', () => {
  it.each([
    ['Loading', 'loading'],
    ['What a source may be', 'what-a-source-may-be'],
    ['<Splats>', 'splats'],
    ['1. The shader', '1-the-shader'],
    ['0.1.0 (not released yet)', '010-not-released-yet'],
    ['Colour & tone', 'colour--tone'],
  ])('of “%s” is “%s”, as GitHub makes it', (heading, anchor) => expect(slug(heading)).toBe(anchor));
});

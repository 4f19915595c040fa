import { expect, test } from 'vitest';
import { BenchError } from './bench-error.ts';
import { chooseBuilt } from './built-pages.ts';

const built = [
  { name: 'websplatter', isFloor: false, version: null, page: 'page-1/index.html?' },
  { name: 'floor-webgl2', isFloor: true, version: null, page: 'page-0/index.html?api=webgl2' },
  { name: 'mine?x', isFloor: false, version: null, page: 'page-2/index.html?x' },
];

test('built peers are chosen by name, with options of their own', () => {
  expect(chooseBuilt('all', built)).toEqual(built);
  expect(chooseBuilt('mine?x,websplatter?accuracy=fast,floor-webgl2?a=1', built)).toEqual([
    built[2],
    { ...built[0], name: 'websplatter?accuracy=fast', page: 'page-1/index.html?accuracy=fast' },
    { ...built[1], name: 'floor-webgl2?a=1', page: 'page-0/index.html?api=webgl2&a=1' },
  ]);
});

test.each(['spark', 'spark?a', ''])('%j is an error that names what there is', (text) => {
  expect(() => chooseBuilt(text, built)).toThrow(BenchError);
  expect(() => chooseBuilt(text, built)).toThrow('this pack has websplatter, floor-webgl2, mine?x');
});

import { readdirSync } from 'node:fs';
import { expect, it } from 'vitest';

const namesIn = (folder: string, ending: string) =>
  readdirSync(new URL(folder, import.meta.url))
    .filter((file) => file.endsWith(ending))
    .map((file) => file.slice(0, -ending.length))
    .sort();

it('there is a picture of each example, and no other', () => {
  expect(namesIn('../thumbnails', '.jpg')).toEqual(namesIn('./routes', '.tsx'));
  expect(namesIn('../../docs/thumbnails', '.jpg')).toEqual(namesIn('../../docs/src/examples', '.ts'));
});

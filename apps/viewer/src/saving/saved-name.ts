import { pathSegment } from '../formatting/path-segment.ts';
import { joinedNames } from '../scene/scene-source.ts';

/** The names of a scene's files, or of what is in them, with another end. */
export function savedName(titles: readonly string[], { extension }: { readonly extension: string }): string {
  const names = titles.map((title) => title.replace(/(\.compressed)?\.[a-z]+$/i, '') || 'scene');
  return pathSegment(`${joinedNames(names)}${extension}`);
}

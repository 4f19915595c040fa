import { joinedNames } from '../engine/scene-source.ts';
import { pathSegment } from '../ui/path-segment.ts';

/** The names of a scene's files, or of what is in them, with another end. */
export function savedName(titles: readonly string[], { extension }: { readonly extension: string }): string {
  const names = titles.map((title) => title.replace(/(\.compressed)?\.[a-z]+$/i, '') || 'scene');
  return pathSegment(`${joinedNames(names)}${extension}`);
}

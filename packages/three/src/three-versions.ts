import { REVISION } from 'three/webgpu';

/** Releases of three, `0.N.x`, that tests draw with: the oldest and the newest. */
export const TESTED_RELEASES = { oldest: 185, newest: 187 } as const;

/** The same in words. */
export const TESTED_RANGE = `three 0.${TESTED_RELEASES.oldest} to 0.${TESTED_RELEASES.newest}`;

let isWarned = false;

/** Warns once on a page whose release of three no test has drawn with; it may draw all the same. */
export function warnOfUntestedThree(revision = REVISION): void {
  const release = Number.parseInt(revision, 10);
  const isTested = release >= TESTED_RELEASES.oldest && release <= TESTED_RELEASES.newest;
  if (isTested || isWarned) return;
  isWarned = true;
  console.warn(
    `This release of @websplatter/three is tested with ${TESTED_RANGE}, and this is r${revision}. If splats are wrong or missing, ` +
      'install one of these, or a newer @websplatter/three.',
  );
}

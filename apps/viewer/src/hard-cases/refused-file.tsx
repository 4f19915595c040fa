import { readSplats, SplatFileError } from '@websplatter/core';
import type { RefusedFileCase } from '@websplatter/hardcases';
import { useEffect, useState } from 'react';

/** A file that must be refused: the expected error, and the actual one. */
export function RefusedFile({ hardCase }: { hardCase: RefusedFileCase }) {
  const [outcome, setOutcome] = useState<Outcome | null>(null);
  useEffect(() => {
    let isGone = false;
    void readOutcome(hardCase).then((read) => {
      if (!isGone) setOutcome(read);
    });
    return () => {
      isGone = true;
    };
  }, [hardCase]);
  const isAsExpected = outcome?.code === hardCase.code;
  return (
    <dl className="page-facts" data-testid="case-refusal">
      <dt>Expected</dt>
      <dd>
        The file is refused as <code>{hardCase.code}</code>
      </dd>
      <dt>Here</dt>
      <dd className={outcome && !isAsExpected ? 'case-bad' : ''}>
        {outcome ? (
          <>
            {isAsExpected ? 'Refused as ' : 'Not as expected: '}
            <code>{outcome.code}</code>. {outcome.message}
          </>
        ) : (
          'Reading…'
        )}
      </dd>
    </dl>
  );
}

interface Outcome {
  /** Code of the error, or `read` if there was none. */
  readonly code: string;
  readonly message: string;
}

async function readOutcome({ file, name }: RefusedFileCase): Promise<Outcome> {
  try {
    const { count } = await readSplats(file(), { name });
    return { code: 'read', message: `It was read, with ${count} splats.` };
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    return { code: error instanceof SplatFileError ? error.code : 'other', message };
  }
}

// Builds the page that “Save as one web page” puts a scene into: the viewer without its interface
// as one file. `scenePage` in vite.config.ts runs this, and adds the page to the viewer.
import { oneFile } from './one-file.ts';

export default oneFile({ page: 'scene-page.html', fileName: 'scene-page.html', scene: null });

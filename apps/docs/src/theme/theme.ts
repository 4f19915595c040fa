import { useRoute, withBase } from 'vitepress';
import DefaultTheme from 'vitepress/theme-without-fonts';
import { defineComponent, h, onMounted, watch } from 'vue';
import './theme.css';
import './playground.css';

/** The theme gives a landmark to documents, but not to the first page and that for missing ones. */
function markMain(): void {
  const content = document.getElementById('VPContent');
  if (content?.querySelector('main')) content.removeAttribute('role');
  else content?.setAttribute('role', 'main');
}

/** VitePress's own theme with the fonts of the system, and the elements of this site. */
export default {
  extends: DefaultTheme,
  Layout: defineComponent({
    setup() {
      // Once the page is Vue's: before that, Vue takes additions of elements for mistakes.
      onMounted(async () => {
        const kit = new URL(withBase('/kit/'), location.href);
        const [{ definePlayground }, { defineMeasure }] = await Promise.all([
          import('../playground/playground-element.ts'),
          import('../live/measure-element.ts'),
        ]);
        definePlayground(kit);
        defineMeasure(kit);
      });
      // biome-ignore lint/correctness/useHookAtTopLevel: setup of Vue, which knows no such rule.
      const route = useRoute();
      onMounted(markMain);
      watch(() => route.data, markMain, { flush: 'post' });
      return () => h(DefaultTheme.Layout);
    },
  }),
};

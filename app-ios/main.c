// Xcode links nothing for a target without sources, so `main` lives here rather than in the library.
_Noreturn void app_ios_main(void);

int main(void) {
    app_ios_main();
}
